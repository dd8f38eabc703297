// SPDX-License-Identifier: MIT
#include "figure/gnuplot_picture.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "ripplenotch/core/visible_text.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
