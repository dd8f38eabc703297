// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/torque_course.hpp"
#include "ripplenotch/core/how_many.hpp"

#include <fmt/format.h>

#include <cmath>

namespace ripplenotch {

namespace {

constexpr double stretch_s = 0.5;
constexpr std::size_t most_in_stretch = 4096, fewest_stretches = 3;

}  // namespace

void CloseUp::add(const CourseSample& sample) {
    const auto& [time_s, speed_deg_s, before_nm, after_nm] = sample;
    const bool full = now_.time_s.size() == most_in_stretch;
    if (!now_.time_s.empty() && (full || time_s - now_.time_s.front() >= stretch_s)) end_stretch();
    if (!now_.time_s.empty()) {
        const double step = (before_nm - after_nm) - (now_.before_nm.back() - now_.after_nm.back());
        if (std::isfinite(step)) now_.taken_off += step * step;
    }
    now_.time_s.push_back(time_s);
    now_.before_nm.push_back(before_nm);
    now_.after_nm.push_back(after_nm);
}

void CloseUp::end_stretch() {
    ++ended_;
    if (now_.taken_off > best_.taken_off) best_ = now_;
    now_ = {};
}

std::optional<Panel> CloseUp::panel() const {
    if (ended_ < fewest_stretches || best_.time_s.empty()) return std::nullopt;
    Panel panel{
        .title = "Close up, where the filter takes off most", .x = {"time", "s"}, .y = {"torque", "Nm"}};
    panel.x.from = best_.time_s.front();
    panel.x.to = best_.time_s.back();
    panel.curves = {{"before", Ink::orange, CurveStyle::line, best_.time_s, best_.before_nm},
                    {"after", Ink::blue, CurveStyle::line, best_.time_s, best_.after_nm}};
    return panel;
}

void TorqueCourse::add(const CourseSample& sample) {
    const auto& [time_s, speed_deg_s, before_nm, after_nm] = sample;
    if (!any_) first_s_ = time_s;
    any_ = true;
    last_s_ = time_s;
    speed_.add(time_s, speed_deg_s);
    before_.add(time_s, before_nm);
    after_.add(time_s, after_nm);
    close_up_.add(sample);
}

Figure TorqueCourse::figure(const std::string& source, const std::string& method,
                            const StreamReport& report) const {
    PlotAxis time{"time", "s"};
    time.from = first_s_;
    time.to = last_s_;
    Figure figure{"torque", fmt::format("{}: {}", source, method), "", {}};
    if (std::optional<Panel> close_up = close_up_.panel()) figure.panels.push_back(std::move(*close_up));
    Panel torque{.title = "Torque before and after", .x = time, .y = {"torque", "Nm"}};
    torque.curves = {before_.curve("before", Ink::orange), after_.curve("after", Ink::blue)};
    Panel speed{.title = "Joint speed", .x = time, .y = {"speed", "deg/s"}, .height = 0.5};
    speed.curves = {speed_.curve("", Ink::black)};
    figure.panels.push_back(std::move(torque));
    figure.panels.push_back(std::move(speed));
    if (report.switches.empty()) return figure;

    Curve band{"",
               Ink::green,
               CurveStyle::steps,
               {first_s_},
               {static_cast<double>(report.switches[0].change.from_band)}};
    Curve jump{"", Ink::vermilion, CurveStyle::stems, {}, {}};
    for (const TimedSwitch& one : report.switches) {
        band.x.push_back(one.time_s);
        band.y.push_back(one.change.to_band);
        jump.x.push_back(one.time_s);
        jump.y.push_back(one.change.jump_nm);
    }
    band.x.push_back(last_s_);
    band.y.push_back(band.y.back());
    Panel in_force{.title = "Band in force (0: none)", .x = time, .y = {"band", ""}, .height = 0.5};
    in_force.curves = {thinned(band)};
    Panel jumps{.title = "Jump of the output at each switch", .x = time, .y = {"jump", "Nm"}, .height = 0.5};
    jumps.curves = {thinned(jump)};
    figure.panels.push_back(std::move(in_force));
    figure.panels.push_back(std::move(jumps));
    figure.sentence =
        fmt::format("{}{}.", how_many(report.switch_count, "change of filter", "changes of filter"),
                    report.switches.size() < report.switch_count
                        ? fmt::format(", the first {} shown", report.switches.size())
                        : "");
    return figure;
}

}  // namespace ripplenotch
