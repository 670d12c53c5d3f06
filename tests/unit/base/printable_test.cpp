// Text on a terminal.
#include "base/text/printable.h"

#include <gtest/gtest.h>

#include <string>

namespace sherd {
namespace {

using std::string_literals::operator""s;

TEST(Printable, EscapesEveryControlCharacter) {
  for (int c = 0; c < 0x20; ++c) {
    char escape[8];
    std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
    EXPECT_EQ(printable(std::string(1, static_cast<char>(c))), escape);
  }
  EXPECT_EQ(printable("a\x7f"
                      "b"),
            "a\\u007fb");
  for (int c = 0x80; c < 0xa0; ++c) {  // the terminal's 8-bit commands, as UTF-8
    char escape[8];
    std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
    EXPECT_EQ(printable("\xc2"s + static_cast<char>(c)), escape);
  }
  EXPECT_EQ(printable("\x1b]0;title\x07"), "\\u001b]0;title\\u0007");
}

TEST(Printable, KeepsLineBreaksOnDemand) {
  EXPECT_EQ(printable("a\nb\r\n"), "a\\u000ab\\u000d\\u000a");
  EXPECT_EQ(printable("a\nb\r\n", LineBreaks::kept), "a\nb\\u000d\n");
}

TEST(Printable, KeepsAllOtherText) {
  for (const std::string text : {"plain ~", "\xc2\xa0", "\xc3\xa9", "\xdf\xbf", "\xe0\xa0\x80",
                                 "\xed\x9f\xbf", "\xee\x80\x80", "\xef\xbf\xbf", "\xf0\x90\x80\x80",
                                 "\xf4\x8f\xbf\xbf", "back\\slash", ""}) {
    EXPECT_EQ(printable(text), text);
  }
}

// Table 3-7 of the Unicode Standard: overlong forms, surrogates, above U+10FFFF, cut characters.
TEST(Printable, EscapesBytesThatAreNotText) {
  EXPECT_EQ(printable("\x9b"
                      "31m"),
            "\\x9b31m");
  EXPECT_EQ(printable("\xff"), "\\xff");
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");
  EXPECT_EQ(printable("\xe0\x80\x9b"), "\\xe0\\x80\\x9b");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xf0\x80\x80\x9b"), "\\xf0\\x80\\x80\\x9b");
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(printable("\xf5\x80\x80\x80"), "\\xf5\\x80\\x80\\x80");
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");
  EXPECT_EQ(printable("\xc3"
                      "a"),
            "\\xc3"
            "a");
}

TEST(Printable, EscapesOnce) {
  for (int first = 0; first < 256; ++first) {
    for (const char* rest : {"", "\x1b", "\x80", "\x9b\x80\x80"}) {
      const std::string once = printable(std::string(1, static_cast<char>(first)) + rest);
      EXPECT_EQ(printable(once), once);
    }
  }
}

}  // namespace
}  // namespace sherd
