// SPDX-License-Identifier: MIT
#include "ripplenotch/figure/figure.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "figure/gnuplot_picture.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

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
