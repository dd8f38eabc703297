// SPDX-License-Identifier: MIT
// Specifications, and text as people see it.
#include <array>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {
const std::array keys = {
    Key{.name = "cutoff",
        .dimension = Dimension::frequency,
        .required = true,
        .above = 0.0,
        .help = "where it is -3 dB"},
    Key{.name = "order", .default_text = "1", .above = 0.0, .at_most = 20.0, .whole = true},
    Key{.name = "dwell", .dimension = Dimension::time, .at_least = 0.0},
    Key{.name = "counts", .kind = KeyKind::list, .at_least = 1.0, .whole = true},
    Key{.name = "centers", .kind = KeyKind::list, .dimension = Dimension::frequency, .above = 0.0},
    Key{.name = "mode", .default_text = "keep", .choices = "keep reset"},
};
Settings settings(std::string_view text) { return Settings("method lowpass", parse_spec(text), keys); }
}  // namespace

TEST_CASE("a specification gives typed values, lists and defaults") {
    const Settings s = settings("lowpass,cutoff=2kHz,centers=25Hz:50Hz:0.1kHz");
    CHECK(s.number("cutoff") == 2000.0);
    CHECK(s.number("order") == 1.0);
    CHECK(s.list("centers") == std::vector<double>{25.0, 50.0, 100.0});
    CHECK(s.text("mode") == "keep");
    CHECK(s.has("order"));
    CHECK_FALSE(settings("lowpass,cutoff=1").has("centers"));
}

TEST_CASE("what was typed can be typed again") {
    CHECK(parse_spec("lowpass,cutoff=13rad/s,order=1").text() == "lowpass,cutoff=13rad/s,order=1");
}

TEST_CASE("a wrong specification names the piece and the remedy") {
    CHECK_THROWS_WITH(settings("lowpass,cutof=3"), Contains("cutof") && Contains("did you mean cutoff?"));
    CHECK_THROWS_WITH(settings("lowpass"), Contains("needs cutoff") && Contains("-3 dB"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=0"), Contains("not above 0 Hz"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,order=21"), Contains("limit of 20"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,mode=drop"), Contains("'drop'") && Contains("keep, reset"));
    CHECK_THROWS_WITH(parse_spec("lowpass,cutoff"), Contains("'cutoff' is not KEY=VALUE"));
    CHECK_THROWS_WITH(parse_spec("lowpass,a=1,a=2"), Contains("a is given twice"));
    CHECK_THROWS_WITH(parse_spec("cutoff=3"), Contains("starts with 'cutoff=3'"));
    CHECK_THROWS_AS(parse_spec(""), UsageError);
}

TEST_CASE("a bound may belong to the range, and numbers may have to be whole") {
    CHECK(settings("lowpass,cutoff=1,dwell=0").number("dwell") == 0.0);
    CHECK(settings("lowpass,cutoff=1,counts=1:3").list("counts") == std::vector<double>{1.0, 3.0});
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,dwell=-1ms"), Contains("dwell: -1ms is below 0 s"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,counts=3:0"), Contains("counts: 0 is below 1"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,order=1.5"), Contains("order: 1.5 is not a whole number"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,counts=1:2.5"), Contains("2.5 is not a whole number"));
}

TEST_CASE("the nearest name is offered only when it is near") {
    const std::vector<std::string> known = {"filter", "identify", "info"};
    CHECK(nearest_name("filtre", known) == "filter");
    CHECK(nearest_name("identfy", known) == "identify");
    CHECK_FALSE(nearest_name("zzz", known).has_value());
}

TEST_CASE("a comma inside brackets separates nothing", "[core]") {
    const Spec spec = parse_spec("tau_rigid[:,1],scale=1,name=log.tau(:,3)");
    CHECK(spec.name == "tau_rigid[:,1]");
    CHECK(spec.values ==
          std::vector<std::pair<std::string, std::string>>{{"scale", "1"}, {"name", "log.tau(:,3)"}});
}

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
