// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

// "oscillator, error 0.0281 Nm rms"
std::string name_with_error(const MethodFigures& figures, const Comparison& comparison) {
    const std::string name =
        part_of(figures) == MethodPart::control ? "raw" : short_name(figures, comparison);
    if (!figures.error_rms_nm) return name;
    return fmt::format("{}, error {:.3g} Nm rms", name, *figures.error_rms_nm);
}

}  // namespace

void ComparedCourse::add(std::size_t method, const TraceView& block, std::span<const double> out_nm,
                         std::span<const double> truth_nm) {
    if (methods_.size() <= method) methods_.resize(method + 1);
    Course& course = methods_[method];
    for (std::size_t k = 0; k < std::min(out_nm.size(), truth_nm.size()); ++k) {
        if (block.starts_run(k)) {
            course.torque.break_here();
            course.error.break_here();
            if (method == 0) truth_.break_here();
        }
        course.torque.add(block.time_s[k], out_nm[k]);
        course.error.add(block.time_s[k], out_nm[k] - truth_nm[k]);
        if (method == 0) truth_.add(block.time_s[k], truth_nm[k]);
    }
}

Figure ComparedCourse::figure(const std::string& source, const Comparison& comparison) const {
    Panel torque{.title = "Torque", .x = {"time", "s"}, .y = {"torque", "Nm"}};
    Panel error{.title = "What each is off the true torque", .x = {"time", "s"}, .y = {"error", "Nm"}};
    error.legend = false;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < std::min(methods_.size(), comparison.methods.size()); ++i) {
        const MethodFigures& figures = comparison.methods[i];
        const Ink ink = part_of(figures) == MethodPart::control ? Ink::grey : series_ink(taken++);
        const std::string name = name_with_error(figures, comparison);
        torque.curves.push_back(methods_[i].torque.curve(name, ink));
        error.curves.push_back(methods_[i].error.curve(name, ink));
    }
    torque.curves.push_back(truth_.curve("true torque", Ink::black));
    torque.curves.back().style = CurveStyle::dashed;
    return {"compared-log",
            fmt::format("Methods on one log: {}", source),
            differences(comparison),
            {std::move(torque), std::move(error)}};
}

namespace {

struct Look {
    Ink ink;
    CurveStyle style;
};

// The control is grey and dashed, methods take the inks in turn.
Look look_of(const Contender& contender, std::size_t& taken) {
    if (contender.method->part == MethodPart::control) return {Ink::grey, CurveStyle::dashed};
    const std::size_t i = taken++;
    return {series_ink(i), series_style(i, CurveStyle::line)};
}

// Short, as in the table; a contender that was not measured by its text.
std::string contender_name(const Comparison& comparison, const Contender& contender) {
    for (const MethodFigures& figures : comparison.methods) {
        if (figures.method == contender.text) return short_name(figures, comparison);
    }
    return contender.text;
}

// Half of the longest settling time before the signal and one and a half after it, within reason.
double shown_s(const Comparison& comparison) {
    double longest_ms = 0.0;
    for (const MethodFigures& figures : comparison.methods)
        if (figures.settle_ms) longest_ms = std::max(longest_ms, figures.settle_ms->front());
    return std::clamp(1.3e-3 * longest_ms, 40.0 / comparison.sample_rate.value(), 10.0);
}

// Output of a filter in steady state at torque 0, then `signal(t)` from t = 0 on.
template <class Signal>
Curve run(const Contender& contender, const std::string& name, const Comparison& comparison,
          double duration_s, const Look& look, const Signal& signal) {
    const double rate = comparison.sample_rate.value();
    const auto before = static_cast<std::size_t>(0.1 * duration_s * rate) + 1;
    const auto count = before + static_cast<std::size_t>(duration_s * rate) + 1;
    std::vector<double> torque(count), position(count), out(count);
    const std::vector<double> velocity(count, comparison.speed.value());
    MinMaxCourse course;
    for (std::size_t k = 0; k < count; ++k) {
        const double t = (static_cast<double>(k) - static_cast<double>(before)) / rate;
        torque[k] = k < before ? 0.0 : signal(t);
        position[k] = comparison.speed.value() * t;
    }
    const auto filter = contender.start_on_bench(comparison.sample_rate);
    filter->process({velocity, torque, position}, out);
    for (std::size_t k = 0; k < count; ++k)
        course.add(1e3 * (static_cast<double>(k) - static_cast<double>(before)) / rate, out[k]);
    Curve curve = course.curve(name, look.ink);
    curve.style = look.style;
    return curve;
}

std::vector<Panel> course_panels(const Comparison& comparison, std::span<const Contender> contenders) {
    std::vector<Panel> panels;
    const double duration_s = shown_s(comparison);
    const auto add = [&](std::string title, const auto& signal) {
        Panel panel{.title = std::move(title), .x = {"time", "ms"}, .y = {"torque", "Nm"}, .legend = false};
        std::size_t taken = 0;
        for (const Contender& contender : contenders) {
            const Look look = look_of(contender, taken);
            panel.curves.push_back(
                run(contender, contender_name(comparison, contender), comparison, duration_s, look, signal));
        }
        panels.push_back(std::move(panel));
    };
    if (comparison.step_nm)
        add(fmt::format("A step of {:.4g} Nm", *comparison.step_nm),
            [height = *comparison.step_nm](double) { return height; });
    if (comparison.ramp_nm_s)
        add(fmt::format("A ramp of {:.4g} Nm/s", *comparison.ramp_nm_s),
            [slope = *comparison.ramp_nm_s](double t) { return slope * t; });
    return panels;
}

// Magnitude, phase and delay of the methods that are a linear filter at the comparison's speed.
std::vector<Panel> response_panels(const Comparison& comparison, std::span<const Contender> contenders) {
    const PlotAxis frequency{"frequency", "Hz", PlotScale::logarithmic};
    Panel magnitude{.title = "Magnitude", .x = frequency, .y = {"gain", "dB"}};
    Panel phase{.title = "Phase", .x = frequency, .y = {"phase", "deg"}, .legend = false};
    Panel delay{.title = "Group delay", .x = frequency, .y = {"delay", "ms"}, .legend = false};
    std::vector<double> lines_hz;
    for (const Order order : comparison.lines ? comparison.lines->orders : std::vector<Order>{}) {
        lines_hz.push_back(ripple_frequency(order, comparison.lines->ratio, comparison.speed).value());
        magnitude.lines.push_back({order_in_words(order, comparison.lines->ratio), NamedLine::Run::at_x,
                                   lines_hz.back(), Ink::black});
    }
    std::size_t taken = 0;
    double longest_dc_ms = 1.0, deepest_db = -20.0;
    for (const Contender& contender : contenders) {
        const Look look = look_of(contender, taken);
        const auto frozen = contender.frozen(comparison.sample_rate, comparison.speed);
        if (!frozen) continue;
        const FilterResponse response = filter_response(frozen->cascade, comparison.sample_rate, lines_hz);
        const auto add = [&](Panel& panel, const std::vector<double>& values) {
            panel.curves.push_back(
                {contender_name(comparison, contender), look.ink, look.style, response.hz, values});
        };
        add(magnitude, response.magnitude_db);
        add(phase, response.phase_deg);
        add(delay, response.group_delay_ms);
        longest_dc_ms = std::max(longest_dc_ms, response.group_delay_ms.front());
        deepest_db = std::min(deepest_db,
                              *std::min_element(response.magnitude_db.begin(), response.magnitude_db.end()));
    }
    if (magnitude.curves.empty()) return {};
    magnitude.y.from = std::max(deepest_db - 5.0, -85.0);
    magnitude.y.to = 8.0;
    // Near a null the delay of a notch is so large that the rest of the picture would be a line: the axis is
    // limited to the delays at low frequencies.
    delay.y.from = -0.25 * longest_dc_ms;
    delay.y.to = 1.25 * longest_dc_ms;
    return {std::move(magnitude), std::move(phase), std::move(delay)};
}

}  // namespace

Figure comparison_figure(const Comparison& comparison, std::span<const Contender> contenders) {
    Figure figure{"comparison",
                  fmt::format("Methods at {:.6g} deg/s, sampled at {:.6g} Hz", comparison.speed.value(),
                              comparison.sample_rate.value()),
                  differences(comparison),
                  {}};
    std::vector<Panel> responses = response_panels(comparison, contenders);
    std::vector<Panel> courses = course_panels(comparison, contenders);
    if (responses.empty() && !courses.empty()) courses.front().legend = true;
    // Frequency at the left, time at the right.
    figure.columns = responses.empty() || courses.empty() ? 1 : 2;
    for (std::size_t i = 0; i < std::max(responses.size(), courses.size()); ++i) {
        if (i < responses.size()) figure.panels.push_back(std::move(responses[i]));
        if (i < courses.size()) figure.panels.push_back(std::move(courses[i]));
    }
    return figure;
}

}  // namespace ripplenotch
