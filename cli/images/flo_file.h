// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_FLO_FILE_H_
#define RSSTAB_CLI_IMAGES_FLO_FILE_H_

#include <iosfwd>
#include <string>

#include "cli/images/npz_reader.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"

namespace rsstab::images {

// Writes a field as a Middlebury .flo file, one displacement for each pixel: "PIEH", width and
// height as 32-bit integers, then u and v of each pixel as 32-bit floats, row by row; all little
// endian. Failures are left in the stream's state.
void WriteFlo(const MotionField& field, std::ostream& out);

// Reads one: 2 x height x width, x then y, pixels that Middlebury calls unknown (beyond 1e9) as
// NaN. Errors: those of ReadWholeFile; kCorruptData naming the file.
[[nodiscard]] Result<NpyArray> ReadFlo(const std::string& path);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_FLO_FILE_H_
