// SPDX-License-Identifier: MIT
#include <cmath>

#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/chart/comparison_figure.hpp"
#include "ripplenotch/chart/track_figure.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
