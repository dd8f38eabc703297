// SPDX-License-Identifier: MIT
#include "ripplenotch/figure/figure.hpp"

#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

Panel panel_of(Curve curve, PlotScale scale = PlotScale::linear) {
    return {.title = "", .x = {"time", "s"}, .y = {"torque", "Nm", scale}, .curves = {std::move(curve)}};
}

// Relative luminance of sRGB, WCAG 2.
double luminance(const std::string& rgb) {
    double sum = 0.0;
    const double weights[] = {0.2126, 0.7152, 0.0722};
    for (int i = 0; i < 3; ++i) {
        const double share =
            std::stoi(rgb.substr(static_cast<std::size_t>(1 + 2 * i), 2), nullptr, 16) / 255.0;
        sum += weights[i] * (share <= 0.03928 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4));
    }
    return sum;
}

}  // namespace

TEST_CASE("an axis spans what is shown, exactly along x and a little more along y") {
    const Panel panel = panel_of({"", Ink::blue, CurveStyle::line, {1.0, 2.0, 4.0}, {-1.0, NAN, 9.0}});
    CHECK(x_range(panel).from == 1.0);
    CHECK(x_range(panel).to == 4.0);
    CHECK(y_range(panel).from == Approx(-1.5));
    CHECK(y_range(panel).to == Approx(9.5));
}

TEST_CASE("a logarithmic axis leaves out what it cannot show") {
    const Panel panel = panel_of({"", Ink::blue, CurveStyle::line, {1.0, 2.0, 3.0}, {0.0, 0.01, 1.0}},
                                 PlotScale::logarithmic);
    CHECK(y_range(panel).from > 0.0);
    CHECK(y_range(panel).from < 0.01);
    CHECK(std::isnan(share_along(y_range(panel), PlotScale::logarithmic, 0.0)));
}

TEST_CASE("an axis is never empty: no points, one point, all alike") {
    for (const std::vector<double>& y : {std::vector<double>{}, {5.0}, {5.0, 5.0}, {0.0}, {NAN}}) {
        for (const PlotScale scale : {PlotScale::linear, PlotScale::logarithmic}) {
            const Panel panel = panel_of({"", Ink::blue, CurveStyle::line, y, y}, scale);
            CHECK(x_range(panel).from < x_range(panel).to);
            CHECK(y_range(panel).from < y_range(panel).to);
        }
    }
}

TEST_CASE("share_along and value_at are each other's inverse") {
    for (const PlotScale scale : {PlotScale::linear, PlotScale::logarithmic}) {
        const PlotRange range{0.5, 80.0};
        for (const double share : {0.0, 0.25, 1.0})
            CHECK(share_along(range, scale, value_at(range, scale, share)) == Approx(share).margin(1e-12));
    }
}

TEST_CASE("a builder's fault is found before anything is drawn") {
    Figure figure{"spectrum", "", "", {panel_of({"", Ink::blue, CurveStyle::line, {1.0, 2.0}, {1.0}})}};
    CHECK_THROWS_AS(check_figure(figure), std::logic_error);
    figure.panels.clear();
    CHECK_THROWS_AS(check_figure(figure), std::logic_error);
    figure.panels = {panel_of({"", Ink::blue, CurveStyle::line, {1.0}, {1.0}})};
    CHECK_NOTHROW(check_figure(figure));
    figure.panels.front().y.label.clear();
    CHECK_THROWS_AS(check_figure(figure), std::logic_error);
}

TEST_CASE("the first six series have colours of their own, none of them too light on white") {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < 6; ++i) {
        const std::string rgb = ink_rgb(series_ink(i));
        seen.insert(rgb);
        // Contrast to white of at least 1.9: the lightest of Okabe and Ito's that is left in.
        CHECK(1.05 / (luminance(rgb) + 0.05) > 1.9);
    }
    CHECK(seen.size() == 6);
}

TEST_CASE("twelve series, and twelve orders, are told apart by colour and mark") {
    for (const CurveStyle style : {CurveStyle::line, CurveStyle::points}) {
        std::set<std::pair<Ink, CurveStyle>> series, orders;
        for (std::size_t i = 0; i < 12; ++i) {
            series.emplace(series_ink(i), series_style(i, style));
            const double order = static_cast<double>(i) + 1.0;
            orders.emplace(order_ink(order), order_style(order, style));
        }
        CHECK(series.size() == 12);
        CHECK(orders.size() == 12);
        CHECK(orders.count({tone_ink, other_mark(style)}) + orders.count({unknown_ink, other_mark(style)}) ==
              0);
    }
    CHECK(order_style(0.5, CurveStyle::points) == CurveStyle::crosses);
    CHECK(order_ink(0.5) == order_ink(1.0));
}
