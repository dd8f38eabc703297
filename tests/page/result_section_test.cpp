// SPDX-License-Identifier: MIT
#include <algorithm>

#include "page/result_section.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/page/page.hpp"
#include "support/catch.hpp"
#include "support/diagnoses.hpp"

using namespace ripplenotch;
using Catch::Contains;

TEST_CASE("a comparison has its methods' names and three digits") {
    const Json methods = Json::parse(R"([
        {"method": "none", "settle_ms": {"0.5": 0.0}, "error_rms_nm": null},
        {"method": "switching,table=long/name/of/a/table.json", "settle_ms": {"0.5": 112.34567},
         "attenuation_db": [{"order": 1.0, "hz": 22.2, "db": 12.3456789}], "ledger": [{"band": 1}]},
        {"method": "oscillator", "settle_ms": null, "ramp_delay_ms": -3.1e-12}])");
    const PageTable table = comparison_table(methods);
    CHECK(table.header == std::vector<std::string>{"method", "settles to 0.5 %, ms", "ramp delay, ms",
                                                   "attenuation of order 1, dB"});
    CHECK(table.rows[0] == std::vector<std::string>{"none", "0", "-", "-"});
    CHECK(table.rows[1] ==
          std::vector<std::string>{"switching, table long/name/of/a/table.json", "112", "-", "12.3"});
    CHECK(table.rows[2] == std::vector<std::string>{"oscillator", "-", "0", "-"});
    CHECK(table.legend.empty());
}

TEST_CASE("the notch table is the design: centre and Q of each order in each band") {
    const Json bands = Json::parse(R"([{"number": 1, "speed_from_deg_s": 18.0, "speed_to_deg_s": 36.0,
        "notches": [{"order": 1.0, "center_hz": 7.49998, "q": 0.25}, {"order": 2.0, "center_hz": 14.99997, "q": 0.3}],
        "dc_delay_ms": 127.27699, "settle_ms": 490.0}])");
    const PageTable table = notch_table(bands);
    CHECK(table.header == std::vector<std::string>{"band", "speed, deg/s", "order 1: centre, Hz",
                                                   "order 1: Q", "order 2: centre, Hz", "order 2: Q",
                                                   "delay at 0 Hz, ms", "settles, ms"});
    CHECK(table.rows[0] ==
          std::vector<std::string>{"1", "18 to 36", "7.5", "0.25", "15", "0.3", "127", "490"});
}

TEST_CASE("130 switches are a histogram and the ten largest, and a few are a table") {
    Json many = Json::array();
    for (int i = 0; i < 130; ++i)
        many.push_back({{"sample", i}, {"jump_nm", i % 2 == 0 ? 0.01 * i : -0.01 * i}});
    const auto figure = switch_figure(many);
    REQUIRE(figure);
    check_figure(*figure);
    double counted = 0.0;
    for (const double count : figure->panels.front().curves.front().y) counted += count;
    CHECK(counted == 130.0);
    const PageTable largest = largest_switches(many);
    CHECK(largest.title == "The 10 largest of 130 switches");
    REQUIRE(largest.rows.size() == 10);
    CHECK(largest.rows.front().front() == "129");
    CHECK(largest.rows.back().front() == "120");
    many.erase(many.begin() + 5, many.end());
    CHECK_FALSE(switch_figure(many));
    CHECK(largest_switches(many).rows.size() == 5);
}

TEST_CASE("what all methods share is not in their names, and two methods have two names") {
    const auto names_of = [](const char* methods) {
        std::vector<std::string> names;
        for (const auto& row : comparison_table(Json::parse(methods)).rows) names.push_back(row[0]);
        return names;
    };
    CHECK(names_of(R"([{"method": "tracking,q=1,gear-ratio=100,orders=1:2"}, {"method": "none"},
                       {"method": "tracking,q=2,gear-ratio=100,orders=1:2"}])") ==
          std::vector<std::string>{"tracking, q 1", "none", "tracking, q 2"});
    CHECK(names_of(R"([{"method": "tracking,gear-ratio=100"}, {"method": "tracking,gear-ratio=50"}])") ==
          std::vector<std::string>{"tracking, gear-ratio 100", "tracking, gear-ratio 50"});
}

TEST_CASE("a verdict is good, doubtful or bad by its data") {
    CHECK(state_of(Json::parse(R"({"conclusive": true})")) == PageState::good);
    CHECK(state_of(Json::parse(R"({"conclusive": false})")) == PageState::doubtful);
    CHECK(state_of(Json::parse("{}")) == PageState::none);
    CHECK(state_of(Json::parse(R"({"verdict": "explained", "rounds": []})")) == PageState::good);
    CHECK(state_of(Json::parse(R"({"verdict": "unexplained", "rounds": []})")) == PageState::doubtful);
    CHECK(state_of(Json::parse(R"({"conclusive": true, "take": "a", "methods": [
        {"method": "a", "attenuation_db": [{"order": 1, "db": 20.0}, {"order": 2, "db": -3.3}]}]})")) ==
          PageState::bad);
    CHECK(state_of(Json::parse(R"({"conclusive": true, "take": "a", "methods": [
        {"method": "a", "attenuation_db": [{"order": 1, "db": -0.07}]}]})")) == PageState::good);
}

TEST_CASE("a page begins with what was asked, the verdict and three numbers, and folds its ledgers") {
    const std::string text = R"({"schema": "ripplenotch/metrics/1", "command": "ripplenotch x",
        "ripple_peak_to_peak_nm": {"raw": 2.60239, "filtered": 1.181297},
        "delays": [{"band": 1, "dc_delay_ms": 127.277}, {"band": 2, "dc_delay_ms": 19.81}],
        "orders": [{"order": 1.0, "raw_nm": 0.9}]})";
    const PageSection section = sections_of_result(text, "m.json").front();
    CHECK(section.title == "Effect of the filter: m.json");
    CHECK(section.in_summary);
    CHECK_THAT(section.verdict, Contains("2.6 Nm") && Contains("1.18 Nm"));
    REQUIRE(section.key.size() == 3);
    CHECK(section.key[2].value == "19.81 to 127.3 ms");
    const std::string html = html_page({"t", {section, section}}, std::nullopt);
    const std::size_t summary = html.find("class=\"summary\""), contents = html.find("<nav>"),
                      first = html.find("<section>");
    REQUIRE(summary != std::string::npos);
    CHECK(summary < contents);
    CHECK(contents < first);
    CHECK(html.find("2.6 Nm") < contents);
    CHECK_THAT(html, Contains("<summary>delays (2 rows)</summary>") &&
                         Contains("prefers-color-scheme: dark") && Contains("href=\"#result-2\"") &&
                         Contains("id=\"result-2\""));
}

TEST_CASE("a hostile or empty document has no key numbers and throws nothing") {
    for (const char* text :
         {"{}", R"({"methods": 1, "bands": {}, "gear_ratio": [], "lines": [1, null, []]})",
          R"({"methods": [1, {"method": 2, "settle_ms": 3}], "ripple_peak_to_peak_nm": "x"})"}) {
        for (const char* kind : {"joint", "table", "metrics", "comparison", "diagnosis"}) {
            CAPTURE(text, kind);
            CHECK(key_numbers(kind, Json::parse(text)).empty());
            CHECK(sentence_of(kind, Json::parse(text)).empty());
        }
    }
    CHECK(heading_of("new-kind") == "new-kind");
}

namespace {

PageSection section_of(const Diagnosis& diagnosis) {
    return sections_of_result(testing::document_of(diagnosis), "d.json").front();
}

const PageTable& table_named(const PageSection& section, const std::string& title) {
    const auto found = std::find_if(section.tables.begin(), section.tables.end(),
                                    [&](const PageTable& one) { return one.title == title; });
    REQUIRE(found != section.tables.end());
    return *found;
}

}  // namespace

TEST_CASE("a diagnosis has its verdict in words, the gap as a figure and its parts as facts and tables") {
    Diagnosis full = testing::full_diagnosis();
    CHECK(section_of(full).verdict == full.doubt);
    full.doubt.clear();
    const PageSection section = section_of(full);
    CHECK(section.verdict ==
          "Missing: quantization, coulomb-friction 0.4999 +/- 0.0011 Nm, tone or ripple; residual 0.435 to "
          "0.0475 Nm rms, noise 0.0474 Nm rms.");
    REQUIRE(section.figures.size() == 1);
    const Panel& panel = section.figures[0].panels[0];
    CHECK(panel.curves[0].y == std::vector<double>{0.434974, 0.0496759, 0.0475});
    CHECK(panel.lines[0].name == "1: coulomb-friction");
    CHECK(panel.lines[1].name == "2: tone (ambiguous)");
    bool told = false;
    for (const PageFact& fact : section.facts)
        told = told || (fact.name == "gap closed, %" && fact.value == "99.9");
    CHECK(told);
    CHECK(table_named(section, "faults").rows[0][0] == "quantization");
    Diagnosis nothing_found;
    nothing_found.model.gear_ratio = GearRatio(100.0);
    CHECK(section_of(nothing_found).verdict == "Nothing is missing; residual 0 to 0 Nm rms, noise 0 Nm rms.");
}

TEST_CASE("the rounds of a diagnosis are a table that fits a page") {
    const PageSection section = section_of(testing::full_diagnosis());
    const PageTable rounds = table_named(section, "rounds");
    CHECK(rounds.header == std::vector<std::string>{"effect", "status", "parameters (95 % interval)",
                                                    "times the noise", "gap, Nm", "validation, Nm", "rivals",
                                                    "reason"});
    REQUIRE(rounds.rows.size() == 2);
    CHECK(rounds.rows[0] == std::vector<std::string>{"coulomb-friction", "confirmed",
                                                     "torque 0.4999 (0.4987 to 0.5010) Nm; width 2 deg/s",
                                                     "8.701", "0.435 to 0.0497", "0.433 to 0.0503", "offset",
                                                     "-"});
    CHECK(rounds.rows[1][2] == "frequency 50.00 (49.90 to 50.10) Hz; amplitude 0.02 Nm; phase 10 deg");
    CHECK(rounds.rows[1][5] == "-");
}
