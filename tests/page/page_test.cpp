// SPDX-License-Identifier: MIT
// A page as a browser gets it, and a result as verdict, facts and tables.
#include <nlohmann/json.hpp>

#include <algorithm>

#include "filter/tables.hpp"
#include "page/result_section.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/page/page.hpp"
#include "support/catch.hpp"
#include "support/diagnoses.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

const std::string hostile = "<script>alert(1)</script> \"'&%{x} <b>$a$ ]]> \x1b[2J";

Figure full_figure() {
    Panel panel{.title = hostile, .x = {"frequency", "Hz", PlotScale::logarithmic}, .y = {hostile, "Nm"}};
    panel.curves.push_back({hostile, Ink::blue, CurveStyle::steps, {1.0, 2.0, 4.0}, {0.0, NAN, 0.5}});
    panel.curves.push_back({"stems", Ink::green, CurveStyle::stems, {1.5}, {0.25}});
    panel.ribbons.push_back({"ribbon", Ink::green, {1.0, 4.0}, {0.0, 0.2}, {0.5, 0.7}});
    panel.lines.push_back({hostile, NamedLine::Run::at_x, 2.0, Ink::black, false});
    panel.lines.push_back({"ray", NamedLine::Run::ray, 0.1});
    panel.shades.push_back({"3", Ink::sky, 1.0, 2.0, -INFINITY, INFINITY});
    panel.height = 0.5;
    panel.legend = false;
    Panel map{.title = "", .x = {"speed", "deg/s"}, .y = {"order", ""}};
    map.map =
        HeatMap{"amplitude", "Nm", PlotScale::logarithmic, 0.1, 1.0, {0.0, 1.0, 2.0}, {0.0, 1.0}, {NAN, 0.8}};
    return {"test", hostile, hostile, {panel, map}, 2};
}

std::string figure_json(const Figure& figure) { return figure_text(figure, {}); }

}  // namespace

TEST_CASE("a figure survives the way to JSON and back") {
    for (const Figure& figure : {full_figure(), table_figure(ripplenotch::testing::paper_table())}) {
        const std::string text = figure_json(figure);
        CHECK(figure_json(figure_from_json(text, "a.json")) == text);
    }
}

TEST_CASE("a figure that is none is refused with the field and the reason") {
    const auto broken = [](const char* pointer, const nlohmann::ordered_json& value) {
        auto json = nlohmann::ordered_json::parse(figure_json(full_figure()));
        json[nlohmann::ordered_json::json_pointer(pointer)] = value;
        return json.dump();
    };
    const auto says = [](const std::string& text, const std::string& part) {
        CHECK_THROWS_WITH(figure_from_json(text, "a.json"), Contains("a.json") && Contains(part));
    };
    says(broken("/panels/0/curves/0/style", "wiggly"), "style");
    says(broken("/panels/0/curves/0/ink", "red"), "ink");
    says(broken("/panels/0/curves/0/x", {1.0}), "differ in length");
    says(broken("/panels/0/curves/0/y", {"<script>", 1, 2}), "numbers and null");
    says(broken("/panels/0/x/from", 0.0), "span");
    says(broken("/panels/0/extra", 1), "extra");
    says(broken("/panels", nlohmann::ordered_json::array()), "no panel");
    says(broken("/schema", "ripplenotch/joint/1"), "schema");
    says("{", "not JSON");
}

TEST_CASE("plotly gets every curve, map and name of a figure, and no markup") {
    const std::string text = plotly_text(full_figure());
    CHECK(text.find('<') == std::string::npos);
    const auto json = nlohmann::json::parse(text);
    REQUIRE(json["data"].size() == 5);  // two curves, a ribbon's two edges, a map
    CHECK(json["layout"]["xaxis"]["type"] == "log");
    CHECK(json["layout"]["xaxis2"]["title"]["text"] == "speed, deg/s");
    const std::string name = json["data"][2]["name"];
    CHECK_THAT(name, !Contains("<") && !Contains("%{") && !Contains("$"));
    CHECK_THAT(name, Contains("&#60;script&#62;"));
    for (const auto& note : json["layout"]["annotations"]) {
        std::string words = note["text"];
        for (std::size_t at = words.find("<br>"); at != std::string::npos; at = words.find("<br>"))
            words.erase(at, 4);
        CHECK_THAT(words, !Contains("<") && !Contains("\x1b"));
    }
    const auto& map = json["data"][4];
    CHECK(map["type"] == "heatmap");
    CHECK(map["z"][0][0].is_null());
    CHECK(map["customdata"][0][1] == 0.8);
}

TEST_CASE("axes that show the same time are linked, others are not") {
    Figure figure = full_figure();
    figure.panels = {figure.panels[1], figure.panels[1], figure.panels[0]};
    const auto layout = nlohmann::json::parse(plotly_text(figure))["layout"];
    CHECK_FALSE(layout["xaxis"].contains("matches"));
    CHECK(layout["xaxis2"]["matches"] == "x");
    CHECK_FALSE(layout["xaxis3"].contains("matches"));
}

TEST_CASE("names of curves that take more rows on a phone have room for them there") {
    Panel panel{.title = "first", .x = {"time", "s"}, .y = {"torque", "Nm"}};
    constexpr int names = 12;
    for (int i = 0; i < names; ++i)
        panel.curves.push_back({"a method with its error, " + std::to_string(100 + i),
                                Ink::blue,
                                CurveStyle::line,
                                {0.0, 1.0},
                                {0.0, 1.0}});
    Figure figure{"test", "t", "s", {panel, panel}, 1};
    figure.panels[1].title = "second";
    auto json = nlohmann::json::parse(plotly_text(figure));
    const auto room_px = [&] {  // from the first row of names to the title below
        const auto& layout = json["layout"];
        const double title = layout["annotations"][1]["y"], first = layout["legend"]["y"];
        REQUIRE(layout["annotations"][1]["text"] == "second");
        return (first - title) * (layout["height"].get<double>() - 44.0);
    };
    const double wide_px = room_px();
    REQUIRE(json.contains("narrow"));
    for (const auto& change : json["narrow"])
        json[nlohmann::json::json_pointer(change["path"].get<std::string>())] = change["value"];
    const double row_px = 20.0, title_px = 18.0;
    CHECK(wide_px >= names / 2 * row_px + title_px);  // two in a row
    CHECK(wide_px < names * row_px);
    CHECK(room_px() >= names * row_px + title_px);

    for (Panel& one : figure.panels) one.curves.resize(1);
    CHECK_FALSE(nlohmann::json::parse(plotly_text(figure)).contains("narrow"));
}

TEST_CASE("a page shows hostile text as text and lets no script run but its own two") {
    const std::string text = figure_json(full_figure());
    Page page{hostile, {sections_of_result(text, hostile).front()}};
    page.sections[0].facts.push_back({hostile, hostile});
    page.sections[0].tables.push_back({hostile, {hostile}, {{hostile}}});
    page.sections[0].command = page.sections[0].json = hostile;
    const std::string html = html_page(page, "var Plotly;");
    CHECK_THAT(html, !Contains("<script>alert") && !Contains("<b>$a$"));
    CHECK_THAT(html, Contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    CHECK_THAT(html, Contains("default-src 'none'") && Contains("script-src 'sha256-") &&
                         !Contains("http://") && !Contains("https://"));
    std::size_t scripts = 0;
    for (std::size_t at = html.find("<script"); at != std::string::npos; at = html.find("<script", at + 1))
        ++scripts;
    CHECK(scripts == 3);  // plotly, ours, and one block of data
    CHECK(html == html_page(page, "var Plotly;"));
}

TEST_CASE("the hash in the policy is that of the script: the empty one's is known") {
    const Page page{"t", {sections_of_result(figure_json(full_figure()), "a.json").front()}};
    const std::string html = html_page(page, "");
    CHECK_THAT(html, Contains("'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='"));
}

TEST_CASE("a page without a figure needs no plotly") {
    const std::string html = html_page({"t", {}}, "var Plotly;");
    CHECK_THAT(html, Contains("script-src 'none'") && !Contains("<script") && !Contains("plotly"));
}

TEST_CASE("commands can be copied, by a script that the policy names") {
    Page page{"t", {{}}};
    page.sections[0].leads = true;
    page.sections[0].commands = {"ripplenotch filter 'a <b>.csv' -o out.csv"};
    const std::string html = html_page(page, std::nullopt);
    CHECK_THAT(html, Contains("<pre>ripplenotch filter &#39;a &lt;b&gt;.csv&#39; -o out.csv</pre><button"));
    CHECK_THAT(html, Contains("script-src 'sha256-") && Contains("<script>"));
}

TEST_CASE("without plotly the page carries pictures, says so, and runs no script") {
    const Page page{"t", {sections_of_result(figure_json(full_figure()), "a.json").front()}};
    const std::string html = html_page(page, std::nullopt);
    CHECK_THAT(html, Contains("plotly.js was not found"));
    CHECK_THAT(html, Contains("script-src 'none'") && !Contains("<script"));
    const auto picture = draw_picture(page.sections[0].figures[0], PictureKind::svg);
    if (!picture) {
        test::skipped("there is no gnuplot here");
        CHECK_THAT(html, Contains("Neither plotly.js nor gnuplot was found"));
        return;
    }
    const std::string before = "src=\"data:image/svg+xml;base64,";
    const std::size_t at = html.find(before);
    REQUIRE(at != std::string::npos);
    const std::size_t from = at + before.size();
    CHECK(html.substr(from, 8) == "PD94bWwg");  // "<?xml "
    CHECK(html.find('"', from) - from == (picture->size() + 2) / 3 * 4);
}

TEST_CASE("any result becomes verdict, facts and tables with units from its names") {
    const std::string text = R"({"schema": "ripplenotch/info/1", "command": "ripplenotch x",
        "inputs": [{"name": "x.csv", "sha256": "ab"}], "verdict": "the clock is right", "rows": 500,
        "clock": {"rate_hz": 1000.0, "jitter_ms": 0.0123456, "gaps": [{"from_s": 0.5, "to_s": 2.25}]},
        "steps": [{"name": "first", "level_nm": 2.0, "settle_ms": {"0.5": 147.0, "1": 130.0}},
                  {"name": "second", "level_nm": 0.123456, "note": "late"}]})";
    const PageSection section = sections_of_result(text, "c.json").front();
    CHECK(section.title == "The log: c.json");
    CHECK(section.verdict == "the clock is right");
    CHECK(section.inputs.size() == 1);
    CHECK(section.figures.empty());
    REQUIRE(section.facts.size() == 3);
    CHECK(section.facts[1].name == "clock rate, Hz");
    CHECK(section.facts[2].value == "0.0123");
    REQUIRE(section.tables.size() == 2);
    CHECK(section.tables[0].title == "clock gaps");
    const std::vector<std::string> header{"name", "level, Nm", "settle 0.5, ms", "settle 1, ms", "note"};
    CHECK(section.tables[1].header == header);
    CHECK(section.tables[1].rows[1] == std::vector<std::string>{"second", "0.123", "-", "-", "late"});
}

TEST_CASE("what is no result is refused by name") {
    CHECK_THROWS_WITH(sections_of_result("time_s,torque_nm\n", "log.csv").front(),
                      Contains("log.csv") && Contains("not JSON"));
    CHECK_THROWS_WITH(sections_of_result("[1]", "a.json").front(),
                      Contains("a.json") && Contains("expected a result"));
    CHECK_THROWS_WITH(sections_of_result("{\"schema\": \"other/1\"}", "a.json").front(), Contains("other/1"));
    CHECK_THROWS_AS(sections_of_result("{\"schema\": \"ripplenotch/joint/1\"}", "a.json").front(), DataError);
    CHECK_THROWS_AS(sections_of_result("{\"schema\": \"ripplenotch/diagnosis/1\"}", "a.json").front(),
                    DataError);
    CHECK_THROWS_AS(sections_of_result("{\"schema\": 1}", "a.json").front(), DataError);
}

TEST_CASE("a value has the digits that its interval or its standard error allows") {
    // Half the interval is 0.00112: two digits of it end at the fourth decimal.
    const Json fitted = {{"value", 0.4998466893}, {"ci95", {0.4987246838, 0.5009686948}}};
    CHECK(field_text(fitted, "value") == "0.4998");
    CHECK(field_text(fitted, "ci95") == "0.4987 to 0.5010");
    const Json ratio = {{"value", 99.998765}, {"stderr", 0.00023}, {"ci95", {99.99830, 99.99923}}};
    CHECK(field_text(ratio, "value") == "99.99877");
    CHECK(field_text(ratio, "stderr") == "0.00023");
    const Json line = {{"order_output", 100.000123}, {"order_output_stderr", 0.0417}};
    CHECK(field_text(line, "order_output") == "100.000");
    CHECK(field_text(line, "order_output_stderr") == "0.042");
    const Json coarse = {{"value", 1234.5}, {"stderr", 321.0}, {"ci95", nullptr}};
    CHECK(field_text(coarse, "value") == "1234");  // an interval that there is not says nothing
}

TEST_CASE("numbers without an error have three or four digits, whole ones all of theirs") {
    const Json row = {
        {"rms_nm", 0.434973912}, {"speed_deg_s", 109.4951234}, {"score", 0.04798308}, {"rows", 123456789},
        {"db", 12.345678},       {"residual_hz", 1.2345678},   {"time_s", 6.503}};
    CHECK(field_text(row, "rms_nm") == "0.435");
    CHECK(field_text(row, "speed_deg_s") == "109.5");
    CHECK(field_text(row, "score") == "0.04798");
    CHECK(field_text(row, "rows") == "123456789");
    CHECK(field_text(row, "db") == "12.3");
    CHECK(field_text(row, "residual_hz") == "1.23");
    CHECK(field_text(row, "time_s") == "6.503");
}

TEST_CASE("where something is stands in one cell, without dust beside large numbers") {
    const Json where = {{"time_s", Json::array()},
                        {"speed_deg_s", {{-112.501, -0.000176435}}},
                        {"order", {1.0, 2.0}},
                        {"direction", nullptr}};
    CHECK(where_text(where) == "speed -112.5 to 0 deg/s; order 1, 2");
    CHECK(parameters_text({{"torque_nm", {{"value", 0.5}, {"ci95", {0.49, 0.51}}}}, {"order", 2.0}}) ==
          "torque 0.500 (0.490 to 0.510) Nm; order 2");
}

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
    CHECK(
        section.verdict ==
        "Missing: coulomb-friction 0.4999 +/- 0.0011 Nm, tone or ripple; the log has quantization; residual "
        "0.435 to 0.0475 Nm rms, noise 0.0474 Nm rms.");
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
