// SPDX-License-Identifier: Apache-2.0
#include "cli/report/html_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "cli/report/base64.h"
#include "cli/report/field_panels.h"
#include "cli/report/page_style.h"

namespace rsstab::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kEvil = "<script>alert(1)</script>\"'& \xFF.mp4";

// A page on which every text is hostile.
std::string EvilPage() {
  HtmlPage page(kEvil, kEvil, kEvil);
  page.BeginSection(kEvil, kEvil);
  page.Add(std::array{Highlight{kEvil, kEvil, kEvil, kEvil}});
  page.Add(Table{kEvil, {kEvil, kEvil}, {{{kEvil}, {kEvil, true}}}});
  page.Add(std::array{Fact{kEvil, kEvil}});
  LineChart chart;
  chart.title = chart.description = chart.x_label = chart.y_label = kEvil;
  chart.series = {{kEvil, {{0, 0}, {1, 1}}}};
  page.Add(std::array{chart});
  page.Add(std::array{BeforeAfter{kEvil, kEvil, kEvil, kEvil, kEvil, kEvil, 4, 3}});
  page.Add(std::array{Panel{kEvil, kEvil, kEvil, 4, 3}});
  page.Add(std::array{ColorKey{kEvil, false, kEvil, kEvil}});
  page.Add(std::array{Share{kEvil, 1.0, kEvil}});
  page.AddText(kEvil);
  page.AddCode(kEvil, kEvil);
  return page.Finish(kEvil);
}

TEST(HtmlPage, EscapesEveryText) {
  const std::string html = EvilPage();
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, Not(HasSubstr("\"'&")));  // no attribute is left
  EXPECT_THAT(html,
              HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt;&quot;&#39;&amp; \xEF\xBF\xBD"));
}

TEST(HtmlPage, ForbidsAndNamesNothingFromElsewhere) {
  const std::string html = EvilPage();
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(html, HasSubstr("script-src " + CspHash(PageScript()) + ";"));
  for (const char* attribute : {"src=", "href="}) {
    for (const char* place : {"http:", "https:", "//"}) {
      for (const char* quote : {"", "'", "\""}) {
        EXPECT_EQ(html.find(std::string(attribute) + quote + place), std::string::npos);
      }
    }
  }
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  EXPECT_THAT(html, Not(HasSubstr("url(")));
}

TEST(HtmlPage, SectionsAreClosed) {
  HtmlPage page("report", "clip.mp4", "");
  page.BeginSection("One");
  page.BeginSection("Two");
  const std::string html = page.Finish("end");
  const auto count = [&html](const std::string& text) {
    std::size_t number = 0;
    for (std::size_t at = html.find(text); at != std::string::npos; at = html.find(text, at + 1)) {
      ++number;
    }
    return number;
  };
  EXPECT_EQ(count("<section>"), 2U);
  EXPECT_EQ(count("</section>"), 2U);
  EXPECT_EQ(count("<main>"), count("</main>"));
  EXPECT_EQ(html.rfind("<!DOCTYPE html>", 0), 0U);
}

TEST(HtmlPage, BarsAreInProportion) {
  HtmlPage page("report", "clip.mp4", "");
  page.Add(std::array{Share{"decode", 2.0, "2 s"}, Share{"render", 8.0, "8 s"}});
  const std::string html = page.Finish("");
  EXPECT_THAT(html, HasSubstr("<span>decode</span><b style=\"width:25.0%\">"));
  EXPECT_THAT(html, HasSubstr("<span>render</span><b style=\"width:100.0%\">"));
}

TEST(Base64, FollowsTheStandard) {
  const auto encoded = [](std::string_view text) {
    return Base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  // RFC 4648, section 10.
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  const std::string long_text(10'000'001, 'x');  // several pieces
  const std::string long_code = encoded(long_text);
  EXPECT_EQ(long_code.size(), 13'333'336U);
  EXPECT_EQ(long_code.find_first_of("=\n", 0), long_code.size() - 1);
}

TEST(CspHash, IsThatOfTheStandard) {
  // The example of the Content Security Policy Level 2 recommendation.
  EXPECT_EQ(CspHash("alert('Hello, world.');"),
            "'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='");
}

TEST(FieldPanel, IsSmallAndKeepsItsShape) {
  MotionField field(1920, 1080, 3, 5);
  field.At(0, 0) = {4, 0};
  const auto panel = FieldPanel(field, 0.0, "frame 3", "");
  ASSERT_TRUE(panel) << panel.error().message;
  EXPECT_EQ(panel->width, 320);
  EXPECT_EQ(panel->height, 180);
  EXPECT_EQ(panel->uri.rfind("data:image/png;base64,", 0), 0U);
  const auto upright = FieldPanel(field, 0.0, "frame 3", "", 1);
  ASSERT_TRUE(upright);
  EXPECT_EQ(upright->width, 180);
  EXPECT_EQ(upright->height, 320);
}

}  // namespace
}  // namespace rsstab::report
