// SPDX-License-Identifier: Apache-2.0
#include "cli/manual_page.h"

#include <cctype>

#include "cli/command_apps.h"
#include "stabilizer/pipeline/version.h"

namespace rsstab::cli {
namespace {

// Text as troff takes it: no dash becomes a hyphen, no line starts a request.
std::string Escape(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '-') {
      out += "\\-";
    } else if (c == '\\') {
      out += "\\e";
    } else {
      out += c;
    }
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string Upper(std::string text) {
  for (char& c : text) {
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return text;
}

std::string CommandSection(const CommandText& text) {
  Invocation unused;
  const auto app = MakeCommandApp(text.id, unused);
  std::string page;
  if (!text.name.empty()) {
    page += ".SH " + Upper(text.name) + "\n.B " + Escape(app->get_name()) + "\n" +
            Escape(text.usage) + "\n.PP\n" + Escape(text.description) + "\n";
  }
  for (const OptionGroup& group : VisibleOptions(*app)) {
    page += ".SS " + (group.heading.empty() ? "Arguments" : group.heading) + "\n";
    for (const CLI::Option* option : group.options) {
      page += ".TP\n.B " + Escape(OptionFlags(*option)) + "\n" + Escape(option->get_description()) +
              "\n";
    }
  }
  page += ".SS Examples\n";
  for (const auto& [line, meaning] : text.examples) {
    page += ".TP\n.B " + Escape(line) + "\n" + Escape(meaning) + "\n";
  }
  return page;
}

}  // namespace

std::string ManualPage() {
  const CommandText& main = TextOf(CommandId::kStabilize);
  std::string page = ".TH RS\\-STABILIZE 1 \"\" \"rs\\-stabilize " +
                     std::string(pipeline::kProgramVersion) +
                     "\" \"User Commands\"\n.SH NAME\nrs\\-stabilize \\- " + Escape(main.summary) +
                     "\n.SH SYNOPSIS\n";
  for (const CommandText& text : CommandTexts()) {
    page += ".B rs\\-stabilize" + (text.name.empty() ? "" : " " + text.name) + "\n" +
            Escape(text.usage) + "\n.br\n";
  }
  page += ".SH DESCRIPTION\n" + Escape(main.description) + "\n.SH OPTIONS\n";
  for (const CommandText& text : CommandTexts()) {
    page += CommandSection(text);
  }
  page +=
      ".SH EXIT STATUS\n0 done, 1 failed or stopped, 2 wrong usage.\n"
      ".SH SIGNALS\nThe first SIGINT, SIGTERM or SIGHUP stops the program cleanly: nothing half "
      "written is left.\nA second one ends it at once.\n";
  return page;
}

}  // namespace rsstab::cli
