// SPDX-License-Identifier: Apache-2.0
#include "cli/report/markup.h"

#include <gtest/gtest.h>

namespace rsstab::report {
namespace {

TEST(Escape, LeavesNoMarkup) {
  EXPECT_EQ(Escape("<script>alert('1' & \"2\")</script>.mp4"),
            "&lt;script&gt;alert(&#39;1&#39; &amp; &quot;2&quot;)&lt;/script&gt;.mp4");
}

TEST(Escape, KeepsTextOfAnyLanguage) {
  EXPECT_EQ(Escape("Zürich \xE6\x9D\xB1\xE4\xBA\xAC \xF0\x9F\x8E\xA5\tend\n"),
            "Zürich \xE6\x9D\xB1\xE4\xBA\xAC \xF0\x9F\x8E\xA5\tend\n");
}

TEST(Escape, ReplacesWhatIsNotText) {
  const std::string bad = "\xEF\xBF\xBD";
  EXPECT_EQ(Escape("a\xFF"
                   "b"),
            "a" + bad + "b");
  EXPECT_EQ(Escape("\x1B[31m"), bad + "[31m");
  EXPECT_EQ(Escape(std::string(1, '\0')), bad);
  EXPECT_EQ(Escape("\xC2\x85"), bad);                  // a control character in two bytes
  EXPECT_EQ(Escape("\xC0\xBC"), bad + bad);            // "<" in an overlong form
  EXPECT_EQ(Escape("\xED\xA0\x80"), bad + bad + bad);  // a surrogate
  EXPECT_EQ(Escape("\xE6\x9D<"), bad + bad + "&lt;");  // cut off: what follows is not swallowed
}

TEST(EscapeName, BreaksBehindSettings) {
  EXPECT_EQ(EscapeName("a@b=1,c"), "a@<wbr>b=1,<wbr>c");
  EXPECT_EQ(EscapeName("<@>"), "&lt;@<wbr>&gt;");
}

}  // namespace
}  // namespace rsstab::report
