// SPDX-License-Identifier: MIT
// Figures of rare results; those of the documentation are compared with their data by
// tests/cli/test_documented.py.
#include <algorithm>
#include <cmath>

#include "filter/tables.hpp"
#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

// The highest point of a curve.
struct Top {
    double x, y;
};
Top top_of(const Curve& curve) {
    Top top{NAN, -INFINITY};
    for (std::size_t i = 0; i < curve.x.size(); ++i)
        if (curve.y[i] > top.y) top = {curve.x[i], curve.y[i]};
    return top;
}

double value_of(const Curve& curve, double x) {
    for (std::size_t i = 0; i < curve.x.size(); ++i)
        if (std::abs(curve.x[i] - x) < 1e-9 * std::abs(x)) return curve.y[i];
    return NAN;
}

}  // namespace

TEST_CASE("speeds that nobody measured are empty columns of a map") {
    SpeedMap map;
    map.axis_kind = Axis::time;
    map.speed_deg_s = {10.0, 12.0, 40.0};
    map.windows = {1, 1, 1};
    map.axis = {0.0, 1.0, 2.0};
    map.amplitude_nm = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}, {7.0, 8.0, 9.0}};
    map.spacing = 1.0;
    map.speed_step_deg_s = 4.0;
    const HeatMap heat = *speed_map_figure("log.csv", map, {}).panels.front().map;
    CHECK(heat.x_edges == std::vector<double>{8.0, 11.0, 14.0, 38.0, 42.0});
    REQUIRE(heat.cells.size() == 12);
    CHECK(heat.cells[0] == 1.0);
    CHECK(heat.cells[1] == 4.0);
    CHECK(std::isnan(heat.cells[2]));
    CHECK(heat.cells[3] == 7.0);
    CHECK(heat.cells[11] == 9.0);
}

TEST_CASE("a hole between bands is a hole in the figure") {
    TableSpec spec = ripplenotch::testing::table_spec();
    spec.bands = {{DegPerSec(20.0), DegPerSec(40.0)}, {DegPerSec(60.0), DegPerSec(80.0)}};
    const Figure figure = table_figure(CandidateTable::design(spec));
    const auto& y = figure.panels.front().curves.front().y;
    CHECK(std::count_if(y.begin(), y.end(), [](double v) { return std::isnan(v); }) == 1);
}

TEST_CASE("a response has its nulls, its -3 dB point and the delay that the table states") {
    const Hertz rate(1000.0);
    const Cascade notches{design_notch({Hertz(25.0)}, rate), design_notch({Hertz(50.0)}, rate)};
    const FilterResponse response = filter_response(notches, rate, {});
    Curve magnitude{"", Ink::blue, CurveStyle::line, response.hz, response.magnitude_db};
    CHECK(*std::min_element(response.magnitude_db.begin(), response.magnitude_db.end()) ==
          lowest_magnitude_db);
    CHECK(std::count_if(response.phase_deg.begin(), response.phase_deg.end(),
                        [](double v) { return std::isnan(v); }) >= 2);
    CHECK(response.group_delay_ms.front() == Approx(38.04).margin(0.01));
    CHECK(response.phase_deg.front() == Approx(0.0).margin(2.0));
    CHECK(std::is_sorted(response.hz.begin(), response.hz.end()));

    const std::vector<double> cutoff{13.0};
    const FilterResponse low = filter_response(design_low_pass({Hertz(13.0), 1}, rate), rate, cutoff);
    CHECK(value_of({"", Ink::blue, CurveStyle::line, low.hz, low.magnitude_db}, 13.0) ==
          Approx(-3.0103).margin(1e-3));
    CHECK(value_of({"", Ink::blue, CurveStyle::line, low.hz, low.phase_deg}, 13.0) ==
          Approx(-45.0).margin(1e-6));
}

TEST_CASE("torque before and after keeps its peaks over two million samples, and the ledger its switches") {
    TorqueCourse course;
    const std::size_t count = 2'000'000;
    for (std::size_t k = 0; k < count; ++k)
        course.add({.time_s = 0.001 * static_cast<double>(k),
                    .speed_deg_s = 90.0,
                    .before_nm = k == 1'234'567 ? 55.0
                                 : k % 2 == 0   ? 1.0
                                                : 1.1,
                    .after_nm = k == 1'234'570 ? -7.0 : 0.5});
    StreamReport report;
    report.switches = {{{100, 0, 3, 20.0, 0.4}, 0.1}, {{900, 3, 4, 80.0, -0.2}, 0.9}};
    report.switch_count = 2;
    const Figure figure = course.figure("log.csv", "switching", report);
    check_figure(figure);
    REQUIRE(figure.panels.size() == 5);
    const Panel& torque = figure.panels[1];
    CHECK(top_of(torque.curves[0]).y == 55.0);
    CHECK(top_of(torque.curves[0]).x == Approx(1234.567));
    CHECK(*std::min_element(torque.curves[1].y.begin(), torque.curves[1].y.end()) == -7.0);
    CHECK(torque.curves[0].x.size() < 20000);
    CHECK(figure.panels[3].curves[0].y == std::vector<double>{0.0, 3.0, 4.0, 4.0});
    CHECK(figure.panels[4].curves[0].y == std::vector<double>{0.4, -0.2});
    CHECK_THAT(figure.sentence, Contains("2 changes"));
}

TEST_CASE("a filter's figure opens where it takes off most, with every sample of half a second") {
    TorqueCourse course;
    for (int k = 0; k < 5000; ++k) {
        const double t = 0.001 * k;
        const double ripple = t >= 2.0 && t < 2.5 ? (k % 20 < 10 ? 0.8 : -0.8) : 0.1;
        course.add({.time_s = t, .speed_deg_s = 90.0, .before_nm = 3.0 + ripple, .after_nm = 3.0});
    }
    const Figure figure = course.figure("log.csv", "switching", {});
    check_figure(figure);
    REQUIRE(figure.panels.size() == 3);
    const Panel& close_up = figure.panels.front();
    CHECK(*close_up.x.from == Approx(2.0));
    CHECK(*close_up.x.to == Approx(2.499));
    CHECK(close_up.curves[0].x.size() == 500);
    TorqueCourse brief;
    for (int k = 0; k < 900; ++k)
        brief.add({.time_s = 0.001 * k, .speed_deg_s = 90.0, .before_nm = 1.0 * (k % 2)});
    CHECK(brief.figure("log.csv", "switching", {}).panels.size() == 2);
}

TEST_CASE("a track's line breaks where the joint turns round or rests, its ribbon too") {
    OrderTracks tracks;
    tracks.time_s = {0.0, 0.1, 0.2, 0.3, 1.3, 1.4, 1.5};
    tracks.speed_deg_s = {10.0, 20.0, -20.0, -10.0, -10.0, -20.0, -20.0};
    const std::vector<double> ones(7, 1.0);
    tracks.lines = {{ones, ones, ones, ones}};
    CHECK(track_breaks(tracks) == std::vector<std::size_t>{2, 4});
    const std::vector<TrackName> names{{"order 2", 2.0}};
    const Figure figure = track_figure("log.csv", tracks, names);
    check_figure(figure);
    const Curve& line = figure.panels.front().curves[0];
    REQUIRE(line.y.size() == 9);
    CHECK(std::isnan(line.y[2]));
    CHECK(std::isnan(line.y[5]));
    CHECK(figure.panels.front().ribbons.size() == 3);
    SpeedTrack by_speed;
    by_speed.speed_deg_s = {10.0, 12.0, 30.0};
    by_speed.step_deg_s = 2.0;
    CHECK(track_breaks(by_speed) == std::vector<std::size_t>{2});
}

TEST_CASE("a joint that keeps its speed still has a map") {
    const std::vector<double> time{0.0, 1.0, 2.0}, speed(3, 90.0), residual{0.1, 0.2, 0.3};
    const Figure figure = residual_figure("Steady", "", {time, speed, {}, residual, {}}, {});
    check_figure(figure);
    CHECK(figure.panels[1].map->highest == Approx(0.3));
}

TEST_CASE("an order has one colour in every figure, and a tone and a line that nobody knows have others") {
    OrderTracks tracks;
    tracks.time_s = {0.0, 1.0};
    tracks.speed_deg_s = {10.0, 20.0};
    tracks.lines.assign(4, {{1.0, 2.0}, {0.1, 0.2}, {30.0, 40.0}, {5.0, 6.0}});
    // Order 2 alone, first of the list, has the colour that it has beside order 1.
    const std::vector<TrackName> names{
        {"order 2", 2.0}, {"60 Hz", {}, true}, {"output order 3", {}, false}, {"order 8", 8.0}};
    const Figure figure = track_figure("log.csv", tracks, names);
    const auto& curves = figure.panels.front().curves;
    CHECK(curves[0].ink == order_ink(2.0));
    CHECK(curves[1].ink == Ink::black);
    CHECK(curves[2].ink == Ink::grey);
    CHECK(curves[3].ink == curves[0].ink);  // the colours begin again: the mark tells them apart
    CHECK(curves[3].style != curves[0].style);
}
