// SPDX-License-Identifier: Apache-2.0
#include "cli/report/markup.h"

#include <cstddef>

namespace rsstab::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

unsigned ByteAt(std::string_view text, std::size_t index) {
  return static_cast<unsigned char>(text[index]);
}

// Bytes of the well-formed UTF-8 sequence at the start of `text` (Unicode, table 3-7), else 0.
std::size_t SequenceLength(std::string_view text) {
  const unsigned lead = ByteAt(text, 0);
  if (lead < 0x80) {
    return 1;
  }
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) {
    return 0;
  }
  // Overlong forms, surrogates and numbers beyond U+10FFFF show in the second byte.
  const unsigned second = ByteAt(text, 1);
  const unsigned low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const unsigned high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (second < low || second > high) {
    return 0;
  }
  for (std::size_t i = 2; i < length; ++i) {
    if ((ByteAt(text, i) & 0xC0U) != 0x80U) {
      return 0;
    }
  }
  return length;
}

// U+0080 to U+009F are control characters, too.
bool IsControl(std::string_view sequence) {
  const unsigned lead = ByteAt(sequence, 0);
  return (lead < 0x20 && lead != '\t' && lead != '\n') || lead == 0x7F ||
         (lead == 0xC2 && ByteAt(sequence, 1) < 0xA0);
}

}  // namespace

std::string Escape(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = SequenceLength(text);
    const std::string_view sequence = text.substr(0, length == 0 ? 1 : length);
    text.remove_prefix(sequence.size());
    if (length == 0 || IsControl(sequence)) {
      escaped += kReplacement;
      continue;
    }
    switch (sequence[0]) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += sequence;
    }
  }
  return escaped;
}

std::string EscapeName(std::string_view text) {
  std::string breakable;
  for (const char c : Escape(text)) {
    breakable += c;
    if (c == '@' || c == ',') {
      breakable += "<wbr>";
    }
  }
  return breakable;
}

}  // namespace rsstab::report
