// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>

#include "figure/gnuplot_picture.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

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

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

Curve noise(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Curve curve;
    for (std::size_t i = 0; i < count; ++i) {
        curve.x.push_back(static_cast<double>(i));
        curve.y.push_back(normal(random));
    }
    return curve;
}

}  // namespace

TEST_CASE("thinning hides no peak: one sample that sticks out anywhere is still there") {
    const std::size_t count = GENERATE(10001U, 65536U, 99999U, 250000U);
    Curve curve = noise(count, 1);
    for (const std::size_t at :
         {std::size_t{0}, std::size_t{1}, count / 3, count / 2 + 17, count - 2, count - 1}) {
        for (const double height : {100.0, -100.0}) {
            Curve spiked = curve;
            spiked.y[at] = height;
            const Curve fewer = thinned(spiked, 500);
            const auto found = std::find(fewer.y.begin(), fewer.y.end(), height);
            INFO("sample " << at << " of " << count);
            REQUIRE(found != fewer.y.end());
            CHECK(fewer.x[static_cast<std::size_t>(found - fewer.y.begin())] == static_cast<double>(at));
        }
    }
}

TEST_CASE("what is left are points that were there, in their order, with the first and the last") {
    const Curve curve = noise(123457, 2);
    const Curve fewer = thinned(curve, 700);
    REQUIRE(fewer.x.size() <= 8 * 700);
    CHECK(fewer.x.front() == curve.x.front());
    CHECK(fewer.x.back() == curve.x.back());
    CHECK(std::is_sorted(fewer.x.begin(), fewer.x.end()));
    for (std::size_t i = 0; i < fewer.x.size(); ++i)
        REQUIRE(fewer.y[i] == curve.y[static_cast<std::size_t>(fewer.x[i])]);
}

TEST_CASE("in every stretch of two buckets the lowest and the highest left are those that were there") {
    const std::size_t count = 1 << 17, buckets = 256;
    const Curve curve = noise(count, 3);
    const Curve fewer = thinned(curve, buckets);
    // Buckets hold between count / (2 * 256) and count / 256 points.
    const std::size_t stretch = 2 * count / buckets;
    std::map<double, double> left;
    for (std::size_t i = 0; i < fewer.x.size(); ++i) left[fewer.x[i]] = fewer.y[i];
    for (std::size_t first = 0; first + stretch <= count; first += stretch / 2) {
        const auto begin = curve.y.begin() + static_cast<std::ptrdiff_t>(first);
        const std::size_t inner = first + stretch / 4;  // a whole bucket lies around here
        const auto highest =
            std::max_element(curve.y.begin() + static_cast<std::ptrdiff_t>(inner),
                             curve.y.begin() + static_cast<std::ptrdiff_t>(inner + stretch / 2));
        double shown = -1e9;
        for (auto it = left.lower_bound(static_cast<double>(first));
             it != left.end() && it->first < static_cast<double>(first + stretch); ++it)
            shown = std::max(shown, it->second);
        CHECK(shown >= *highest);
        CHECK(shown <= *std::max_element(begin, begin + static_cast<std::ptrdiff_t>(stretch)));
    }
}

TEST_CASE("a short curve stays as it is") {
    const Curve curve = noise(4000, 4);
    const Curve same = thinned(curve, 1000);
    CHECK(same.x == curve.x);
    CHECK(same.y == curve.y);
}

TEST_CASE("a gap stays a gap, and nan breaks the line") {
    MinMaxCourse course(100);
    for (int i = 0; i < 5; ++i) course.add(i, 1.0);
    course.break_here();
    for (int i = 100; i < 105; ++i) course.add(i, 2.0);
    course.add(105, nothing);
    course.add(106, 3.0);
    const Curve curve = course.curve("", Ink::blue);
    CHECK(std::count_if(curve.y.begin(), curve.y.end(), [](double y) { return std::isnan(y); }) == 2);
    CHECK(std::isnan(curve.y[5]));
    CHECK(curve.y.back() == 3.0);
}

TEST_CASE("ten million points take bounded memory") {
    MinMaxCourse course;
    for (int i = 0; i < 10'000'000; ++i) course.add(i, std::fmod(i * 0.618, 1.0));
    const Curve curve = course.curve("", Ink::blue);
    CHECK(curve.x.size() <= 8 * shown_buckets);
    CHECK(curve.x.size() >= shown_buckets);
}

TEST_CASE("a map on fewer cells keeps its highest cell, and empty cells stay empty") {
    HeatMap map{.label = "amplitude"};
    for (int i = 0; i <= 1000; ++i) map.x_edges.push_back(i);
    for (int i = 0; i <= 700; ++i) map.y_edges.push_back(i);
    map.cells.assign(1000 * 700, 0.1);
    const std::size_t column = GENERATE(0U, 1U, 333U, 998U, 999U);
    const std::size_t row = GENERATE(0U, 350U, 699U);
    map.cells[row * 1000 + column] = 7.0;
    for (std::size_t r = 0; r < 700; ++r)
        for (std::size_t c = 400; c < 500; ++c) map.cells[r * 1000 + c] = nothing;
    const HeatMap raster = rasterised(map, {0.0, 1000.0}, PlotScale::linear, {0.0, 700.0}, PlotScale::linear,
                                      {.columns = 50, .rows = 30});
    REQUIRE(raster.cells.size() == 1500);
    CHECK(raster.cells[row * 30 / 700 * 50 + column * 50 / 1000] == 7.0);
    CHECK(std::isnan(raster.cells[15 * 50 + 22]));
    CHECK(raster.cells[15 * 50 + 30] == 0.1);
}

namespace {

const std::string hostile =
    "<script>alert(1)</script> \"'`touch ripplenotch_was_here` $(touch x)\n!touch ripplenotch_was_here\n@m "
    "_a^b{c} ]]> & \\ % é";

Figure hostile_figure() {
    Panel panel{.title = hostile, .x = {hostile, hostile}, .y = {hostile, "Nm"}};
    panel.curves.push_back({hostile, Ink::blue, CurveStyle::line, {0.0, 1.0, 2.0}, {0.0, 1.0, 0.5}});
    panel.ribbons.push_back({hostile, Ink::green, {0.0, 2.0}, {0.0, 0.2}, {0.5, 0.7}});
    panel.lines.push_back({hostile, NamedLine::Run::at_x, 1.0});
    panel.lines.push_back({hostile, NamedLine::Run::at_y, 0.5});
    panel.shades.push_back({hostile, Ink::sky, 0.0, 2.0, 0.0, 1.0});
    panel.map = HeatMap{.label = hostile, .unit = hostile};
    panel.map->x_edges = {0.0, 1.0, 2.0};
    panel.map->y_edges = {0.0, 1.0};
    panel.map->cells = {0.2, 0.8};
    return {"test", hostile, hostile, {panel}};
}

// "" without gnuplot, with a word on the skipping.
std::string picture(const Figure& figure, PictureKind kind) {
    const auto drawn = draw_picture(figure, kind);
    if (!drawn) WARN("SKIPPED: there is no gnuplot here");
    return drawn.value_or("");
}

}  // namespace

TEST_CASE("a string for gnuplot holds nothing that its parser looks at") {
    const std::string quoted = gnuplot_string(hostile);
    CHECK(quoted.front() == '"');
    CHECK(quoted.back() == '"');
    const std::string inner = quoted.substr(1, quoted.size() - 2);
    CHECK(inner.find_first_of("\"'`$@{}%!\n<>&_^#;") == std::string::npos);
    // A backslash stands only before three octal digits.
    for (std::size_t at = inner.find('\\'); at != std::string::npos; at = inner.find('\\', at + 1)) {
        REQUIRE(at + 3 < inner.size());
        for (std::size_t i = 1; i <= 3; ++i) CHECK((inner[at + i] >= '0' && inner[at + i] <= '7'));
    }
}

TEST_CASE("every string of bytes survives into a gnuplot string as visible text, byte for byte") {
    for (int byte = 0; byte < 256; ++byte) {
        const std::string text = "a" + std::string(1, static_cast<char>(byte)) + "b";
        const std::string quoted = gnuplot_string(text);
        std::string read;
        for (std::size_t at = 1; at + 1 < quoted.size(); ++at) {
            if (quoted[at] != '\\') {
                read += quoted[at];
                continue;
            }
            read += static_cast<char>(std::stoi(quoted.substr(at + 1, 3), nullptr, 8));
            at += 3;
        }
        CHECK(read == visible_text(text));
    }
}

TEST_CASE("a logarithmic axis of a decade or two has more numbers than its powers of ten") {
    CHECK(gnuplot_ticks({0.004, 0.09}, PlotScale::logarithmic) == "(0.005, 0.01, 0.02, 0.05)");
    CHECK(gnuplot_ticks({1.0, 10.0}, PlotScale::logarithmic) == "(1, 2, 5, 10)");
    CHECK(gnuplot_ticks({1e-5, 1.0}, PlotScale::logarithmic).empty());
    CHECK(gnuplot_ticks({0.0, 10.0}, PlotScale::linear).empty());
    CHECK(gnuplot_ticks({3.0, 4.0}, PlotScale::logarithmic).empty());
}

TEST_CASE("an axis of counts has numbers at whole values alone, a dozen at most") {
    CHECK(gnuplot_ticks({-0.5, 1.5}, PlotScale::whole) == "1");
    CHECK(gnuplot_ticks({-0.5, 11.5}, PlotScale::whole) == "1");
    CHECK(gnuplot_ticks({-0.5, 13.5}, PlotScale::whole) == "2");
    CHECK(gnuplot_ticks({0.0, 25.0}, PlotScale::whole) == "5");
    CHECK(gnuplot_ticks({0.0, 119.0}, PlotScale::whole) == "10");
    CHECK(gnuplot_ticks({0.0, 121.0}, PlotScale::whole) == "20");
    CHECK(share_along({0.0, 4.0}, PlotScale::whole, 1.0) == 0.25);
    CHECK(value_at({0.0, 4.0}, PlotScale::whole, 0.25) == 1.0);
}

TEST_CASE("hostile names are drawn as text and run nothing") {
    const std::string svg = picture(hostile_figure(), PictureKind::svg);
    if (svg.empty()) return;
    CHECK_FALSE(std::filesystem::exists("ripplenotch_was_here"));
    CHECK_THAT(svg, !Contains("<script"));
    CHECK_THAT(svg, !Contains("]]>"));
    CHECK_THAT(svg, Contains("&lt;script>"));
    CHECK_THAT(svg, Contains("_a^b{c}"));
    CHECK_THAT(svg, Contains("\\n!touch"));
}

TEST_CASE("the same figure gives the same bytes, without a clock or a version in them") {
    for (const PictureKind kind : {PictureKind::svg, PictureKind::png, PictureKind::pdf}) {
        const std::string first = picture(hostile_figure(), kind);
        if (first.empty()) return;
        CHECK(first == picture(hostile_figure(), kind));
        CHECK_THAT(first, !Contains("GNUPLOT"));
        CHECK_THAT(first, !Contains("cairo 1."));
        CHECK_THAT(first, !Contains("/CreationDate (D:20"));
    }
}

TEST_CASE("a PDF keeps its length when clock and version go, since it counts its own bytes") {
    const std::string pdf =
        "<< /Producer (cairo 1.16.0 (https://cairographics.org))\n   /CreationDate (D:20261121135235Z)\n>>";
    const std::string same = same_pdf(pdf);
    CHECK(same.size() == pdf.size());
    CHECK_THAT(same, Contains("/CreationDate (D:19700101000000Z)"));
    CHECK_THAT(same, Contains("/Producer (cairo                    "));
    CHECK(same_pdf("no such thing") == "no such thing");
}

TEST_CASE("an SVG loses its version and its empty groups, and nothing else") {
    CHECK(same_svg("<a>\n<desc>Produced by GNUPLOT</desc>\n<g fill=\"none\" color=\"black\">\n</g>\n<g "
                   "fill=\"none\" color=\"red\">\n<path/></g>\n<text>]]></text>\n</a>") ==
          "<a>\n\n<g fill=\"none\" color=\"red\">\n<path/></g>\n<text>]]&gt;</text>\n</a>");
    CHECK(same_svg("").empty());
}

TEST_CASE("a figure without points is drawn with its axes") {
    const Figure figure{"test", "Empty", "", {{.title = "", .x = {"time", "s"}, .y = {"torque", "Nm"}}}};
    const std::string svg = picture(figure, PictureKind::svg);
    if (svg.empty()) return;
    CHECK_THAT(svg, Contains("time, s") && Contains("torque, Nm"));
}

TEST_CASE("in the terminal no line is wider than asked for and nothing but text comes out") {
    for (const int columns : {40, 80, 132}) {
        const auto drawn = draw_text(hostile_figure(), columns);
        if (!drawn) {
            WARN("SKIPPED: there is no gnuplot here");
            return;
        }
        std::size_t from = 0;
        for (std::size_t to = drawn->find('\n'); to != std::string::npos; to = drawn->find('\n', from)) {
            const std::string line = drawn->substr(from, to - from);
            INFO(line);
            CHECK(text_width(line) <= static_cast<std::size_t>(columns));
            CHECK(visible_text(line) == line);
            from = to + 1;
        }
        CHECK_THAT(*drawn, Contains("<script>"));
    }
}

namespace {

Figure crowded(int lines, int columns) {
    Panel panel{.title = "Panel", .x = {"frequency", "Hz"}, .y = {"amplitude", "Nm"}};
    panel.curves.push_back({"torque", Ink::blue, CurveStyle::line, {0.0, 100.0}, {0.0, 1.0}});
    panel.curves.push_back({std::string(70, 'w'), Ink::green, CurveStyle::line, {0.0, 100.0}, {1.0, 0.0}});
    for (int i = 0; i < lines; ++i) {
        panel.lines.push_back({"line " + std::to_string(i), NamedLine::Run::at_x, 40.0 + 0.3 * i});
        panel.lines.push_back({"level " + std::to_string(i), NamedLine::Run::at_y, 0.5 + 0.001 * i});
        panel.lines.push_back({"order " + std::to_string(i), NamedLine::Run::ray, 0.004 * (i + 1)});
    }
    return {"test", std::string(300, 'T'), std::string(400, 's'), {panel, panel, panel}, columns};
}

}  // namespace

TEST_CASE("labels pushed apart keep their distance, their order and their edge") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> anywhere(-50.0, 650.0);
    for (const std::size_t count : {1U, 2U, 12U, 40U}) {
        std::vector<double> wanted(count);
        for (double& one : wanted) one = anywhere(random);
        const auto placed = pushed_apart(wanted, 15.0, 0.0, 600.0);
        auto sorted = placed;
        std::sort(sorted.begin(), sorted.end());
        CHECK(sorted.front() >= -1e-9);
        CHECK(sorted.back() <= 600.0 + 1e-9);
        for (std::size_t k = 1; k < count; ++k) CHECK(sorted[k] - sorted[k - 1] >= 15.0 - 1e-6);
        for (std::size_t a = 0; a < count; ++a)
            for (std::size_t b = 0; b < count; ++b)
                if (wanted[a] < wanted[b]) CHECK(placed[a] < placed[b]);
    }
}

TEST_CASE("labels that have room stay where their lines are") {
    CHECK(pushed_apart({100.0, 50.0, 200.0}, 15.0, 0.0, 600.0) == std::vector<double>{100.0, 50.0, 200.0});
}

TEST_CASE("nothing on a page overlaps or leaves it, however crowded") {
    for (const int lines : {0, 1, 6}) {
        for (const int columns : {1, 2}) {
            const Figure figure = crowded(lines, columns);
            const PictureLayout page = lay_out(figure);
            double above = 14.0 + 20.0 * static_cast<double>(page.title.size()) +
                           line_px * static_cast<double>(page.sentence.size());
            REQUIRE(page.panels.size() == 3);
            for (std::size_t i = 0; i < page.panels.size(); ++i) {
                const PanelLayout& box = page.panels[i];
                if (i % static_cast<std::size_t>(columns) == 0 && i > 0) {
                    const PanelLayout& upper = page.panels[i - static_cast<std::size_t>(columns)];
                    above = upper.legend_y + line_px * upper.legend_rows;
                }
                INFO("panel " << i << ", " << lines << " lines, " << columns << " columns");
                CHECK(box.title_y - 8.0 >= above);
                CHECK(box.left + 150.0 < box.right);
                CHECK(box.top < box.bottom);
                CHECK(box.legend_y >= box.bottom + 40.0);
                CHECK(box.legend_y + line_px * box.legend_rows <= page.height);
                const double page_right =
                    page.width / columns * static_cast<double>(i % static_cast<std::size_t>(columns) + 1);
                for (const LineLabel& label : box.labels) {
                    const double long_px = small_letter_px * static_cast<double>(text_width(label.text));
                    if (label.on_top) {
                        CHECK(box.top - 17.0 - long_px >= box.title_y);
                    } else {
                        CHECK(box.right + 15.0 + long_px <= page_right);
                    }
                }
            }
        }
    }
}
