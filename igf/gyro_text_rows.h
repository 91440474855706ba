// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_TEXT_ROWS_H_
#define RSSTAB_IGF_GYRO_TEXT_ROWS_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "igf/base/result.h"
#include "igf/gyro_log.h"

namespace rsstab::igf {

// Lines of a text log, split into fields. Blank lines and comments (#, //, %) are passed over;
// LF, CRLF and a UTF-8 byte order mark are understood. The text must outlive the reader.
class TextRows {
 public:
  struct Row {
    std::size_t line = 0;                  // counted from 1, as editors do
    std::vector<std::string_view> fields;  // without surrounding blanks and quotes
    bool is_last_and_open = false;         // the text ends here, in the middle of the line
  };

  explicit TextRows(std::string_view text);

  // Fields are split at commas, semicolons or tabs, whichever the line has: a semicolon or tab
  // takes precedence, as commas then are decimal ones.
  [[nodiscard]] std::optional<Row> Next();

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

// A number as spreadsheets and loggers write it ("+1.5e-3", "1,5" where commas do not separate);
// "nan" and "inf" are numbers too. Empty when anything else stands there.
[[nodiscard]] std::optional<double> ParseNumber(std::string_view field);

// Where the numbers of a row stand and what they mean.
struct GyroColumns {
  std::size_t time = 0;
  std::array<std::size_t, 3> rate = {1, 2, 3};
  double time_scale = 1.0;                               // to seconds
  Eigen::Vector3d rate_scale = Eigen::Vector3d::Ones();  // to rad/s, per column
  Eigen::Matrix3d camera_from_sensor = Eigen::Matrix3d::Identity();
};

// The remaining rows as a log. A last line that breaks off is left out, with a note.
// Errors: kCorruptData with the line: a field missing, not a number or not finite, time that
// repeats or runs backwards; those of GyroLog::Create.
[[nodiscard]] Result<GyroLog> ReadGyroRows(TextRows& rows, const GyroColumns& columns,
                                           const GyroLogOptions& limits,
                                           std::vector<std::string>* notes);

// What of a piece of a file may appear in a message: printable, short, in quotes.
[[nodiscard]] std::string Quoted(std::string_view text);

// ASCII lower case.
[[nodiscard]] std::string ToLower(std::string_view text);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_TEXT_ROWS_H_
