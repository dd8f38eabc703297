// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/compared_course.hpp"

#include <fmt/format.h>

#include <algorithm>

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
            verdict(comparison),
            {std::move(torque), std::move(error)}};
}

}  // namespace ripplenotch
