// SPDX-License-Identifier: Apache-2.0
#include "cli/help_page.h"

#include <sstream>

#include "cli/command_apps.h"

namespace rsstab::cli {
namespace {

constexpr std::size_t kColumns = 80;
constexpr std::size_t kHelpColumn = 26;  // where descriptions start

// `text` broken into lines of at most kColumns, each behind `indent` blanks; the first line follows
// what stands already in `column` columns.
std::string Wrap(const std::string& text, std::size_t column, std::size_t indent) {
  std::string out;
  std::istringstream words(text);
  std::string word;
  bool line_start = true;
  while (words >> word) {
    if (!line_start && column + 1 + word.size() > kColumns) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
      line_start = true;
    }
    if (!line_start) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
    line_start = false;
  }
  return out + "\n";
}

std::string Row(const std::string& left, const std::string& right) {
  std::string row = "  " + left;
  if (row.size() + 2 > kHelpColumn) {
    row += "\n" + std::string(kHelpColumn, ' ');
  } else {
    row.resize(kHelpColumn, ' ');
  }
  return row + Wrap(right, kHelpColumn, kHelpColumn);
}

}  // namespace

std::string HelpPage(CommandId id) {
  const CommandText& text = TextOf(id);
  Invocation unused;
  const auto app = MakeCommandApp(id, unused);
  const std::string program = app->get_name();

  std::string page = "Usage: " + program + " " + text.usage + "\n";
  if (text.name.empty()) {
    page += "       rs-stabilize COMMAND ... (see below)\n";
  }
  page += "\n" + Wrap(text.description, 0, 0);
  for (const OptionGroup& group : VisibleOptions(*app)) {
    page += "\n" + (group.heading.empty() ? "Arguments" : group.heading) + ":\n";
    for (const CLI::Option* option : group.options) {
      page += Row(OptionFlags(*option), option->get_description());
    }
  }
  if (text.name.empty()) {
    page += "\nCommands (rs-stabilize COMMAND --help tells more):\n";
    for (const CommandText& command : CommandTexts()) {
      if (!command.name.empty()) {
        page += Row(command.name, command.summary);
      }
    }
  }
  page += "\nExamples:\n";
  for (const auto& [line, meaning] : text.examples) {
    page += "  " + line + "\n      " + meaning + "\n";
  }
  if (text.name.empty()) {
    page += "\nExit status: 0 done, 1 failed, 2 wrong usage.\n";
  }
  return page;
}

}  // namespace rsstab::cli
