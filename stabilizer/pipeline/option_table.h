// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_OPTION_TABLE_H_
#define RSSTAB_STABILIZER_PIPELINE_OPTION_TABLE_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::pipeline {

// The pass of the two-pass program that an option belongs to.
enum class OptionStage { kAnalysis, kRender, kBoth };

// Everything that a parser, a help page, a manual or a plugin host needs to know of one option of
// the struct `Options`. Values travel as text, so that every host parses, checks and prints alike.
template <typename Options>
struct OptionSpec {
  std::string name;        // without dashes: "gyro-offset"
  char short_name = '\0';  // 'o' for -o; none by default
  std::string value_name;  // "S", "FILE", "auto|gyro|off"; empty for a switch
  std::string range;       // "0 to 10"; empty when value_name says it all
  std::string help;        // one sentence or two; neither default nor range (they are added)
  std::string group;       // heading under which the help lists it
  OptionStage stage = OptionStage::kBoth;
  bool repeatable = false;  // each use adds a value

  // Stores the value written in `text` ("true"/"false" for a switch). Errors: kInvalidArgument with
  // a sentence that names the option, the value and the rule it broke; `options` is then unchanged.
  std::function<Status(Options& options, const std::string& text)> set;
  // The stored value as text that `set` understands; empty = not given, the program chooses.
  std::function<std::string(const Options& options)> get;

  [[nodiscard]] bool IsSwitch() const { return value_name.empty(); }
};

template <typename Options>
using OptionTable = std::vector<OptionSpec<Options>>;

// Fills a table heading by heading.
template <typename Options>
class OptionTableBuilder {
 public:
  // Heading and stage of what is added next.
  void Group(std::string heading, OptionStage stage = OptionStage::kBoth) {
    group_ = std::move(heading);
    stage_ = stage;
  }
  void Add(OptionSpec<Options> spec) {
    spec.group = group_;
    spec.stage = stage_;
    table_.push_back(std::move(spec));
  }
  void Add(OptionSpec<Options> spec, const std::string& help) {
    spec.help = help;
    Add(std::move(spec));
  }
  [[nodiscard]] OptionTable<Options> Take() { return std::move(table_); }

 private:
  std::string group_;
  OptionStage stage_ = OptionStage::kBoth;
  OptionTable<Options> table_;
};

// Number <-> text, independent of the locale. Parsing wants the whole text to be one finite number.
[[nodiscard]] std::optional<double> ParseReal(const std::string& text);
[[nodiscard]] std::optional<std::int64_t> ParseInteger(const std::string& text);
[[nodiscard]] std::optional<bool> ParseSwitch(const std::string& text);
[[nodiscard]] std::string FormatReal(double value);

// A range of allowed numbers, ends included. An infinite end is left out of the printed range.
struct RealRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool Contains(double value) const { return value >= min && value <= max; }
  // "0 to 10", "1 or more", or empty.
  [[nodiscard]] std::string Text() const;
};

// "--name: 'text' is not a number in the range 0 to 10"
[[nodiscard]] tl::unexpected<Error> BadOption(const std::string& name, const std::string& text,
                                              const std::string& rule);

// ---- Makers of the usual kinds. Text and range are filled in; help, group and stage by the caller
// or the builder.

// A number stored as `text * scale` (scale 0.001 stores a value given in ms as seconds).
template <typename Options, typename Field>
OptionSpec<Options> RealOption(const std::string& name, const std::string& value_name,
                               Field Options::*field, RealRange range, double scale = 1.0) {
  OptionSpec<Options> spec;
  spec.name = name;
  spec.value_name = value_name;
  spec.range = range.Text();
  spec.set = [name, field, range, scale](Options& options, const std::string& text) -> Status {
    const std::optional<double> value = ParseReal(text);
    if (!value || !range.Contains(*value)) {
      return BadOption(name, text, "a number in the range " + range.Text());
    }
    options.*field = *value * scale;
    return {};
  };
  spec.get = [field, scale](const Options& options) -> std::string {
    const std::optional<double> value = options.*field;
    return value ? FormatReal(*value / scale) : std::string();
  };
  return spec;
}

// A whole number.
template <typename Options, typename Field>
OptionSpec<Options> IntegerOption(const std::string& name, const std::string& value_name,
                                  Field Options::*field, std::int64_t min, std::int64_t max) {
  OptionSpec<Options> spec;
  const RealRange range{static_cast<double>(min), max == std::numeric_limits<std::int64_t>::max()
                                                      ? std::numeric_limits<double>::infinity()
                                                      : static_cast<double>(max)};
  spec.name = name;
  spec.value_name = value_name;
  spec.range = range.Text();
  spec.set = [name, field, min, max, range](Options& options, const std::string& text) -> Status {
    const std::optional<std::int64_t> value = ParseInteger(text);
    if (!value || *value < min || *value > max) {
      return BadOption(name, text, "a whole number in the range " + range.Text());
    }
    options.*field = static_cast<Field>(*value);
    return {};
  };
  spec.get = [field](const Options& options) { return std::to_string(options.*field); };
  return spec;
}

template <typename Options>
OptionSpec<Options> SwitchOption(const std::string& name, bool Options::*field) {
  OptionSpec<Options> spec;
  spec.name = name;
  spec.set = [name, field](Options& options, const std::string& text) -> Status {
    const std::optional<bool> value = ParseSwitch(text);
    if (!value) {
      return BadOption(name, text, "true or false");
    }
    options.*field = *value;
    return {};
  };
  spec.get = [field](const Options& options) {
    return std::string(options.*field ? "true" : "false");
  };
  return spec;
}

// Any text, a file name for example.
template <typename Options>
OptionSpec<Options> TextOption(const std::string& name, const std::string& value_name,
                               std::string Options::*field, char short_name = '\0') {
  OptionSpec<Options> spec;
  spec.name = name;
  spec.short_name = short_name;
  spec.value_name = value_name;
  spec.set = [field](Options& options, const std::string& text) -> Status {
    options.*field = text;
    return {};
  };
  spec.get = [field](const Options& options) { return options.*field; };
  return spec;
}

// One of a few words.
template <typename Options, typename Enum>
OptionSpec<Options> ChoiceOption(std::string name, Enum Options::*field,
                                 std::vector<std::pair<std::string, Enum>> choices) {
  OptionSpec<Options> spec;
  spec.name = name;
  for (const auto& [word, value] : choices) {
    spec.value_name += (spec.value_name.empty() ? "" : "|") + word;
  }
  spec.set = [name, field, choices, words = spec.value_name](Options& options,
                                                             const std::string& text) -> Status {
    for (const auto& [word, value] : choices) {
      if (word == text) {
        options.*field = value;
        return {};
      }
    }
    return BadOption(name, text, "one of " + words);
  };
  spec.get = [field, choices](const Options& options) -> std::string {
    for (const auto& [word, value] : choices) {
      if (value == options.*field) {
        return word;
      }
    }
    return "?";  // not a value of the enum: `set` refuses it
  };
  return spec;
}

// Applies every rule of `table` to a struct filled by hand. Errors: the first broken rule's.
template <typename Options>
[[nodiscard]] Status ValidateOptions(const OptionTable<Options>& table, const Options& options) {
  for (const OptionSpec<Options>& spec : table) {
    const std::string text = spec.get(options);
    Options scratch = options;
    if (!text.empty() && !spec.repeatable) {
      if (Status status = spec.set(scratch, text); !status) {
        return status;
      }
    }
  }
  return {};
}

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_OPTION_TABLE_H_
