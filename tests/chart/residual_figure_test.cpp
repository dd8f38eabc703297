// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/trend_figure.hpp"

#include <cmath>
#include <tuple>

#include "ripplenotch/chart/track_figure.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
