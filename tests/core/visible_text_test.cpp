// SPDX-License-Identifier: MIT
#include "ripplenotch/core/visible_text.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("text that only shows stays as it is, in any script") {
    for (const std::string text : {"torque Nm", "<script>alert(1)</script>", "Drehmoment größer",
                                   "関節トルク", "a_b^c{d}@e%f", "\"quoted\" 'twice' `id`", "🦾"})
        CHECK(visible_text(text) == text);
}

TEST_CASE("what would act is written out") {
    CHECK(visible_text("a\nb\tc\rd") == "a\\nb\\tc\\rd");
    CHECK(visible_text("\x1b[2J\x07") == "\\x1b[2J\\x07");
    CHECK(visible_text(std::string("a\0b", 3)) == "a\\x00b");
    CHECK(visible_text("\xc2\x9b") == "\\u009b");                    // a control sequence in one character
    CHECK(visible_text("\xe2\x80\xaegpj.exe") == "\\u202egpj.exe");  // turns the direction of writing
    CHECK(visible_text("\xef\xbb\xbfx") == "\\ufeffx");
}

TEST_CASE("bytes that are not UTF-8 are written out one by one") {
    CHECK(visible_text("\xff\xfe") == "\\xff\\xfe");
    CHECK(visible_text("gr\xfc\xdf") == "gr\\xfc\\xdf");
    CHECK(visible_text("\xc0\xaf") == "\\xc0\\xaf");           // a slash in two bytes
    CHECK(visible_text("\xed\xa0\x80") == "\\xed\\xa0\\x80");  // half of a pair
    CHECK(visible_text("\xe2\x82") == "\\xe2\\x82");           // cut short
    CHECK(visible_text("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
}

TEST_CASE("lengths count characters, not bytes") {
    CHECK(text_width("größe") == 5);
    CHECK(cut_to("größe", 5) == "größe");
    CHECK(cut_to("größer", 5) == "größ…");
}

TEST_CASE("lines are broken at blanks, and within a word only when it is too long") {
    CHECK(wrapped("one two three", 8) == std::vector<std::string>{"one two", "three"});
    CHECK(wrapped("eleventwelve x", 6) == std::vector<std::string>{"eleven", "twelve", "x"});
    CHECK(wrapped("", 6) == std::vector<std::string>{""});
    CHECK(wrapped("ääääää", 3) == std::vector<std::string>{"äää", "äää"});
}

TEST_CASE("JSON keeps its value and loses what acts") {
    CHECK(visible_json("{\n  \"a\": \"größer 🦾\"\n}\n") == "{\n  \"a\": \"größer 🦾\"\n}\n");
    CHECK(visible_json("[\"\x7f\xc2\x9b\xe2\x80\xae\xef\xbb\xbf\"]") == "[\"\\u007f\\u009b\\u202e\\ufeff\"]");
    CHECK(visible_json("[\"\xf0\x9f\xbf\xbf\"]") == "[\"\\ud83f\\udfff\"]");  // no character, beyond 16 bits
}
