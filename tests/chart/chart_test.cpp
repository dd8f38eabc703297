// SPDX-License-Identifier: MIT
// Figures show the numbers that the results hold, where they belong.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "analysis/traces.hpp"
#include "filter/tables.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/chart/comparison_figure.hpp"
#include "ripplenotch/chart/diagnosis_figure.hpp"
#include "ripplenotch/chart/spectrum_figure.hpp"
#include "ripplenotch/chart/table_figure.hpp"
#include "ripplenotch/chart/track_figure.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::tests;
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

Trace at_speed(double speed_deg_s, double seconds = 4.0) {
    return make_trace({.seconds = seconds,
                       .speed_deg_s = [speed_deg_s](double) { return speed_deg_s; },
                       .ripple = {{100.0, 0.8, 0.3}, {200.0, 0.5, 1.0}},
                       .noise_nm = 0.02});
}

}  // namespace

TEST_CASE("a spectrum's figure names its peaks and keeps their height, even of a long log") {
    const Trace trace = at_speed(90.0, 60.0);
    const Spectrum spectrum = torque_spectrum(trace.view(), {});
    const Figure figure = spectrum_figure("log.csv", spectrum, false);
    check_figure(figure);
    const Panel& panel = figure.panels.front();
    REQUIRE(panel.lines.size() == 2);
    CHECK_THAT(panel.lines[0].name, Contains("25 Hz") && Contains("0.8 Nm"));
    CHECK(panel.lines[1].value == Approx(50.0).margin(0.01));
    CHECK(panel.curves[0].x.size() < spectrum.hz.size());
    const auto highest = std::max_element(spectrum.amplitude_nm.begin(), spectrum.amplitude_nm.end());
    CHECK(top_of(panel.curves[0]).y == *highest);
    CHECK(axis_text(panel.x) == "frequency, Hz");
    CHECK_THAT(figure.sentence, Contains("2 lines") && !Contains("--domain order"));
    CHECK_THAT(spectrum_figure("log.csv", spectrum, true).sentence, Contains("--domain order"));
}

TEST_CASE("order lines run through the ridges of a Campbell diagram and of an order map") {
    const Trace trace = make_trace({.seconds = 20.0,
                                    .speed_deg_s = [](double t) { return 20.0 + 7.0 * t; },
                                    .ripple = {{100.0, 0.8, 0.0}},
                                    .noise_nm = 0.01});
    const OutputAngle angle = output_angle(trace.view());
    const auto speed = smoothed_speed(trace.view());
    for (const Axis axis : {Axis::time, Axis::angle}) {
        const SpeedMap map = speed_map(trace.view(), angle.turns, speed, {.axis = axis});
        const Figure figure = speed_map_figure(
            "log.csv", map, {GearAccount{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, ""}, false});
        check_figure(figure);
        const Panel& panel = figure.panels.front();
        const HeatMap& heat = *panel.map;
        const std::size_t columns = heat.x_edges.size() - 1;
        CHECK(heat.highest == Approx(0.8).epsilon(0.15));
        for (std::size_t column = 0; column < columns; ++column) {
            std::size_t best = 0;
            double highest = 0.0;
            for (std::size_t row = 0; row + 1 < heat.y_edges.size(); ++row) {
                if (heat.cells[row * columns + column] > highest) {
                    highest = heat.cells[row * columns + column];
                    best = row;
                }
            }
            if (highest < 0.4) continue;
            const double middle_deg_s = 0.5 * (heat.x_edges[column] + heat.x_edges[column + 1]);
            const double expected =
                axis == Axis::time ? panel.lines[0].value * middle_deg_s : panel.lines[0].value;
            const double slack = 2.0 * (heat.y_edges[best + 1] - heat.y_edges[best]) +
                                 (axis == Axis::time ? 100.0 * map.speed_step_deg_s / 360.0 : 0.0);
            CHECK(heat.y_edges[best] == Approx(expected).margin(slack));
        }
    }
}

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

TEST_CASE("identify's figure shows every line at every speed on the fitted ray") {
    std::vector<Trace> traces;
    for (const double speed : {60.0, 120.0, 180.0}) traces.push_back(at_speed(speed));
    std::vector<TraceView> views;
    for (const Trace& trace : traces) views.push_back(trace.view());
    const Identification found = identify(views, {});
    const Figure figure = identification_figure("three logs", found);
    check_figure(figure);
    CHECK(figure.sentence == found.verdict);
    const Panel& panel = figure.panels.front();
    REQUIRE(panel.curves.size() == 2);
    REQUIRE(panel.lines.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        REQUIRE(panel.curves[i].x.size() == 3);
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(panel.curves[i].y[k] == Approx(panel.lines[i].value * panel.curves[i].x[k]).epsilon(1e-3));
    }
}

TEST_CASE("the candidate table's figure is the paper's figure 4: centres step along the ripple") {
    const Figure figure = table_figure(ripplenotch::testing::paper_table());
    check_figure(figure);
    const Panel& centres = figure.panels.front();
    REQUIRE(centres.curves.size() == 2);
    CHECK(centres.curves[0].y.front() == 7.5);  // table 1, candidate 1
    CHECK(centres.curves[1].y.back() == 95.0);  // candidate 9
    CHECK(centres.shades.size() == 9);
    REQUIRE(centres.lines.size() == 2);
    CHECK(centres.lines[0].value == Approx(100.0 / 360.0));
    // A step is never further from the ripple than half a band is wide.
    for (std::size_t i = 0; i < centres.curves[0].x.size(); ++i) {
        CHECK(centres.curves[0].y[i] ==
              Approx(centres.lines[0].value * centres.curves[0].x[i]).margin(2.5 + 1e-9));
    }
    CHECK(figure.panels[2].curves[0].y.front() == Approx(127.3).margin(0.05));  // delay of band 1, in ms
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

TEST_CASE("step and ramp in a comparison's figure are those that the bench measures") {
    const std::vector<Contender> contenders{make_contender(parse_spec("none")),
                                            make_contender(parse_spec("lowpass,cutoff=13rad/s,order=1"))};
    Comparison comparison;
    comparison.sample_rate = Hertz(1000.0);
    comparison.speed = DegPerSec(90.0);
    comparison.step_nm = 10.0;
    comparison.ramp_nm_s = 20.0;
    comparison.lines = GearAccount{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, ""};
    for (const Contender& one : contenders) {
        comparison.methods.push_back(measure_on_signals(one, comparison.sample_rate, comparison.speed, 10.0,
                                                        20.0, &*comparison.lines));
    }
    const Figure figure = comparison_figure(comparison, contenders);
    check_figure(figure);
    CHECK(figure.columns == 2);
    REQUIRE(figure.panels.size() == 5);
    const Panel& step = figure.panels[1];
    REQUIRE(step.curves.size() == 2);
    const double settle_ms = comparison.methods[1].settle_ms->front();
    const Curve& slow = step.curves[1];
    for (std::size_t i = 0; i < slow.x.size(); ++i) {
        if (slow.x[i] < 0.0) CHECK(slow.y[i] == 0.0);
        if (slow.x[i] > settle_ms + 1.0) CHECK(slow.y[i] == Approx(10.0).epsilon(0.005));
    }
    const Panel& ramp = figure.panels[3];
    const double lag = (ramp.curves[0].y.back() - ramp.curves[1].y.back()) / 20.0;
    CHECK(1e3 * lag == Approx(*comparison.methods[1].ramp_delay_ms).epsilon(0.02));
}

TEST_CASE("torque before and after keeps its peaks over two million samples, and the ledger its switches") {
    TorqueCourse course;
    const std::size_t count = 2'000'000;
    for (std::size_t k = 0; k < count; ++k)
        course.add({.time_s = 0.001 * static_cast<double>(k),
                    .speed_deg_s = 90.0,
                    .before_nm = k == 1'234'567 ? 55.0 : 1.0,
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

TEST_CASE("methods on one log stand beside the true torque, each with its error") {
    Comparison comparison;
    comparison.methods.resize(2);
    comparison.methods[0].method = "none";
    comparison.methods[0].error_rms_nm = 0.5;
    comparison.methods[1].method = "oscillator";
    comparison.methods[1].error_rms_nm = 0.025;
    ComparedCourse course;
    CHECK(course.empty());
    const std::vector<double> time{0.0, 0.5}, speed{90.0, 90.0}, raw{1.5, 0.5}, out{1.0, 1.25},
        truth{1.0, 1.0};
    const TraceView block{.sample_rate = Hertz(2.0),
                          .time_s = time,
                          .velocity_deg_s = speed,
                          .torque_nm = raw,
                          .position_deg = {}};
    course.add(0, block, raw, truth);
    course.add(1, block, out, truth);
    const Figure figure = course.figure("log.csv", comparison);
    check_figure(figure);
    REQUIRE(figure.panels.size() == 2);
    REQUIRE(figure.panels[0].curves.size() == 3);
    CHECK(figure.panels[0].curves[0].name == "raw, error 0.5 Nm rms");
    CHECK(figure.panels[0].curves[1].name == "oscillator, error 0.025 Nm rms");
    CHECK(figure.panels[0].curves[2].y == truth);
    CHECK(figure.panels[1].curves[1].y == std::vector<double>{0.0, 0.25});
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

TEST_CASE("the gap falls from round to round in the figure as it did, each round named, down to the floor") {
    Diagnosis diagnosis;
    for (const auto& [name, before_nm, after_nm] :
         {std::tuple{"coulomb-friction", 2.0, 1.1}, {"ripple", 1.1, 0.3}}) {
        Finding& finding = diagnosis.rounds.emplace_back();
        finding.term.effect = &find_effect(name);
        finding.gap_before_nm = before_nm;
        finding.gap_after_nm = after_nm;
    }
    diagnosis.gap.noise_floor_nm = 0.25;
    const Figure figure = gap_figure("Gap", diagnosis);
    check_figure(figure);
    const Panel& panel = figure.panels.front();
    CHECK(panel.curves[0].x == std::vector<double>{0.0, 1.0, 2.0});
    CHECK(panel.curves[0].y == std::vector<double>{2.0, 1.1, 0.3});
    CHECK(panel.x.scale == PlotScale::whole);  // there is no round 0.5
    REQUIRE(panel.lines.size() == 3);
    CHECK(panel.lines[0].name == "1: coulomb-friction");
    CHECK(panel.lines[1].value == 2.0);
    CHECK(panel.lines[2].value == 0.25);
    diagnosis.rounds.clear();
    const Figure nothing = gap_figure("Nothing was added", diagnosis);
    check_figure(nothing);
    CHECK(nothing.panels.front().curves[1].y ==
          std::vector<double>{diagnosis.gap.before_nm});  // and no empty panel
}

TEST_CASE("a residual's map is as high where the models disagree as the disagreement is, and nowhere else") {
    std::vector<double> time, speed, position, before, after;
    for (int k = 0; k < 20000; ++k) {
        const double t = 0.001 * k;
        time.push_back(t);
        speed.push_back(60.0 * std::sin(t));
        position.push_back(-60.0 * std::cos(t));
        before.push_back(speed.back() > 30.0 ? 2.0 : 0.1);
        after.push_back(0.1);
    }
    const Figure figure = residual_figure("Residual", "", {time, speed, position, before, after}, 0.1);
    check_figure(figure);
    REQUIRE(figure.panels.size() == 3);
    const HeatMap& first = *figure.panels[1].map;
    const HeatMap& second = *figure.panels[2].map;
    CHECK(first.highest == Approx(2.0));
    CHECK(second.highest == first.highest);
    const std::size_t across = first.x_edges.size() - 1;
    for (std::size_t i = 0; i < first.cells.size(); ++i) {
        if (std::isnan(first.cells[i])) continue;
        const std::size_t row = i / across;
        if (first.y_edges[row] > 30.0) CHECK(first.cells[i] == Approx(2.0));
        if (first.y_edges[row + 1] < 30.0) CHECK(first.cells[i] == Approx(0.1));
        CHECK(second.cells[i] == Approx(0.1));
    }
    CHECK(residual_figure("One", "", {time, speed, {}, before, {}}, {}).panels.size() == 2);
}

TEST_CASE("a joint that keeps its speed still has a map") {
    const std::vector<double> time{0.0, 1.0, 2.0}, speed(3, 90.0), residual{0.1, 0.2, 0.3};
    const Figure figure = residual_figure("Steady", "", {time, speed, {}, residual, {}}, {});
    check_figure(figure);
    CHECK(figure.panels[1].map->highest == Approx(0.3));
}

TEST_CASE("a track's ribbon is twice its standard error") {
    OrderTracks tracks;
    tracks.time_s = {0.0, 1.0};
    tracks.speed_deg_s = {10.0, 20.0};
    tracks.lines = {{{1.0, 2.0}, {0.1, 0.2}, {30.0, 40.0}, {5.0, 6.0}}};
    const std::vector<TrackName> names{{"order 1", 1.0}};
    const Figure figure = track_figure("log.csv", tracks, names);
    check_figure(figure);
    const Panel& panel = figure.panels.front();
    CHECK(panel.curves[0].y == std::vector<double>{1.0, 2.0});
    CHECK(panel.ribbons[0].low == std::vector<double>{0.8, 1.6});
    CHECK(panel.ribbons[0].high == std::vector<double>{1.2, 2.4});
    CHECK(figure.panels[1].curves[0].y == std::vector<double>{30.0, 40.0});
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
