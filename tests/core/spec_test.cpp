#include "ripplenotch/core/spec.hpp"

#include <array>

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {
constexpr std::array<std::string_view, 2> modes = {"keep", "reset"};
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
    Key{.name = "mode", .kind = KeyKind::choice, .default_text = "keep", .choices = modes},
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
