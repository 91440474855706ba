// SPDX-License-Identifier: Apache-2.0
#include "cli/shell_completion.h"

#include <algorithm>
#include <map>

#include "cli/command_apps.h"

namespace rsstab::cli {
namespace {

// Names like PX or FILE stand for a value; words in lower case are the value.
std::string WordsOf(const std::string& value_name) {
  std::string words;
  std::size_t from = 0;
  while (from <= value_name.size()) {
    const std::size_t to = std::min(value_name.find('|', from), value_name.size());
    const std::string word = value_name.substr(from, to - from);
    if (!word.empty() && word.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") == std::string::npos) {
      words += (words.empty() ? "" : " ") + word;
    }
    from = to + 1;
  }
  return words;
}

}  // namespace

std::string BashCompletion() {
  std::string commands;
  std::string flags_by_command;
  std::map<std::string, std::string> words_by_flag;
  std::string value_flags;  // they take a value that is no file and no word
  for (const CommandText& text : CommandTexts()) {
    Invocation unused;
    const auto app = MakeCommandApp(text.id, unused);
    std::string flags;
    for (const OptionGroup& group : VisibleOptions(*app)) {
      for (const CLI::Option* option : group.options) {
        if (option->get_positional()) {
          continue;
        }
        const std::string flag = "--" + option->get_lnames().front();
        flags += (flags.empty() ? "" : " ") + flag;
        const std::string type = option->get_type_name();
        if (option->get_items_expected_max() == 0 || type == "FILE" || type == "FOLDER" ||
            type == "DIR") {
          continue;  // nothing follows, or what the shell completes by itself
        }
        words_by_flag[flag] = WordsOf(type);
      }
    }
    if (!text.name.empty()) {
      commands += (commands.empty() ? "" : " ") + text.name;
    }
    flags_by_command +=
        "    " + (text.name.empty() ? "*" : text.name) + ") flags=\"" + flags + "\" ;;\n";
  }
  // The main job's `*` pattern must come last in the case statement.
  const std::size_t first_line = flags_by_command.find('\n') + 1;
  flags_by_command = flags_by_command.substr(first_line) + flags_by_command.substr(0, first_line);

  std::string values;
  for (const auto& [flag, words] : words_by_flag) {
    values +=
        "    " + flag + ") COMPREPLY=($(compgen -W \"" + words + "\" -- \"$cur\")); return ;;\n";
  }
  return "# bash completion for rs-stabilize\n"
         "_rs_stabilize() {\n"
         "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} flags\n"
         "  COMPREPLY=()\n"
         "  case $prev in\n" +
         values +
         "  esac\n"
         "  case ${COMP_WORDS[1]} in\n" +
         flags_by_command +
         "  esac\n"
         "  if [[ $cur == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$flags\" -- \"$cur\"))\n"
         "  elif [[ $COMP_CWORD -eq 1 ]]; then\n"
         "    COMPREPLY=($(compgen -W \"" +
         commands +
         "\" -- \"$cur\") $(compgen -f -- \"$cur\"))\n"
         "  fi\n"
         "}\n"
         "complete -o default -o filenames -F _rs_stabilize rs-stabilize\n";
}

}  // namespace rsstab::cli
