// SPDX-License-Identifier: MIT
#include "ripplenotch/export/target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

namespace {

constexpr double settled_to = 1e-10;  // share of the first step; a hundredth of the deepest measured notch
constexpr std::size_t longest_run = 4'000'000;  // samples; slower sections are verified by their coefficients
constexpr std::size_t shortest_window = 4096;   // chosen, not derived
constexpr double periods_in_window = 8.0;       // chosen, not derived

double as_db(double gain) { return 20.0 * portable::log10(gain); }

double depth_of(double gain) {
    return gain > 0.0 ? std::min(-as_db(gain), deepest_measured_db) : deepest_measured_db;
}

// tan^2(pi f / fs) of the pair of roots of c0 z^2 + c1 z + c2; not positive when they have left the circle's
// neighbourhood and no frequency belongs to them.
double warped_square(double c0, double c1, double c2) { return (c0 + c1 + c2) / (c0 - c1 + c2); }

struct RunFigures {
    double mean_nm, gain;
};

// Load and ripple together, as in use: a float32 sum that keeps the load has fewer digits left for the
// ripple. Mean and amplitude are the least-squares fit over whole samples, so no period has to fit.
std::optional<RunFigures> run_one_section(const LoadedSection& section, Hertz frequency, Hertz sample_rate) {
    const Biquad cascade[] = {section.biquad};
    if (!(pole_radius(section.biquad) < 1.0)) return std::nullopt;
    std::size_t settling = 0;
    try {
        settling = samples_to_settle(cascade, settled_to);
    } catch (const UsageError&) {
        return std::nullopt;
    }
    const auto periods = static_cast<std::size_t>(std::ceil(periods_in_window * (sample_rate / frequency)));
    const std::size_t window = std::max(shortest_window, periods);
    if (settling + window > longest_run) return std::nullopt;
    std::vector<double> in(settling + window), out(in.size());
    const double step = 2.0 * std::numbers::pi * (frequency / sample_rate);
    // In fixed point load and ripple are a share of the full scale, so that nothing is cut off.
    const double scale = is_fixed(section.arithmetic.precision)
                             ? section.arithmetic.full_scale_nm / (2.0 * (verify_load_nm + 1.0))
                             : 1.0;
    for (std::size_t k = 0; k < in.size(); ++k)
        in[k] = scale * (verify_load_nm + portable::sin(step * static_cast<double>(k)));
    run_section(section, in, out);
    for (double& value : out) value /= scale;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t k = settling; k < in.size(); ++k) {
        const double angle = step * static_cast<double>(k);
        const Eigen::Vector3d row(1.0, portable::cos(angle), portable::sin(angle));
        normal += row * row.transpose();
        right += row * (out[k] - verify_load_nm);
    }
    const Eigen::VectorXd fit = SymmetricFactors(normal).solve(Eigen::VectorXd(right));
    return RunFigures{fit[0], portable::hypot(fit[1], fit[2])};
}

std::string label(const SectionCheck& check) {
    const std::string where = check.band > 0 ? fmt::format("band {}, ", check.band) : "";
    return fmt::format("{}section {} ({:.6g} Hz)", where, check.section, check.center.value());
}

}  // namespace

SectionCheck check_response(const Biquad& f, const ExportSection& designed, Hertz sample_rate) {
    SectionCheck check;
    check.order = designed.order;
    check.gear_ratio = designed.gear_ratio;
    check.center = designed.center;
    check.is_notch = designed.notch.has_value();
    if (check.is_notch && designed.notch->depth_db < infinite_depth_db)
        check.designed_gain = portable::pow(10.0, -designed.notch->depth_db / 20.0);
    const double poles = warped_square(1.0, f.a1, f.a2);
    const double roots = check.is_notch ? warped_square(f.b0, f.b1, f.b2) : poles;
    if (roots > 0.0 && std::isfinite(roots)) {
        const Hertz center = sample_rate * (portable::atan(std::sqrt(roots)) / std::numbers::pi);
        check.shift_percent = 100.0 * (center / designed.center - 1.0);
    }
    check.q = poles > 0.0 ? std::sqrt(poles) * (1.0 - f.a1 + f.a2) / (2.0 * (1.0 - f.a2)) : 0.0;
    check.response_depth_db = depth_of(std::abs(response(f, designed.center, SampledAt(sample_rate))));
    check.pole_radius = pole_radius(f);
    return check;
}

std::vector<SectionCheck> verify_export(const FilterSet& filters, const LoadedFilters& loaded,
                                        const std::string& source) {
    if (loaded.bands.size() > filters.bands.size() || loaded.bands.empty()) {
        raise<DataError>("{}: read {} bands, expected {}", source, loaded.bands.size(), filters.bands.size());
    }
    std::vector<SectionCheck> checks;
    for (std::size_t b = 0; b < loaded.bands.size(); ++b) {
        const ExportBand& band = filters.bands[b];
        if (loaded.bands[b].size() != band.sections.size()) {
            raise<DataError>("{}: read {} sections in band {}, expected {}", source, loaded.bands[b].size(),
                             band.number, band.sections.size());
        }
        for (std::size_t i = 0; i < band.sections.size(); ++i) {
            const LoadedSection& section = loaded.bands[b][i];
            SectionCheck check = check_response(section.biquad, band.sections[i], filters.sample_rate);
            check.band = band.number;
            check.from = band.from;
            check.to = band.to;
            check.section = static_cast<int>(i) + 1;
            if (const auto figures = run_one_section(section, check.center, filters.sample_rate)) {
                if (check.is_notch) check.depth_db = depth_of(figures->gain);
                check.mean_error_nm = figures->mean_nm;
                check.dc_error_db = as_db(std::abs(1.0 + figures->mean_nm / verify_load_nm));
            }
            checks.push_back(check);
        }
    }
    return checks;
}

std::vector<std::string> export_violations(const std::vector<SectionCheck>& checks,
                                           std::optional<double> tolerance_percent) {
    std::vector<std::string> found;
    for (const SectionCheck& check : checks) {
        if (!(check.pole_radius < 1.0)) {
            found.push_back(fmt::format("{}: unstable, pole radius {:.9f}", label(check), check.pole_radius));
            continue;
        }
        if (!tolerance_percent) continue;
        const auto hold = [&](std::string_view what, double percent) {
            if (std::abs(percent) <= *tolerance_percent) return;
            found.push_back(fmt::format("{}: {} {:.4g} %, tolerance {} %", label(check), what, percent,
                                        shortest(*tolerance_percent)));
        };
        if (check.shift_percent)
            hold("centre shifted by", *check.shift_percent);
        else
            found.push_back(fmt::format("{}: no centre is left, its zeros are real", label(check)));
        if (check.is_notch) {
            const double gain = portable::pow(10.0, -check.depth_db.value_or(check.response_depth_db) / 20.0);
            hold("gain error at the centre", 100.0 * (gain - check.designed_gain));
        }
        if (check.mean_error_nm)
            hold("gain error at 0 Hz", 100.0 * *check.mean_error_nm / verify_load_nm);
        else
            found.push_back(
                fmt::format("{}: too slow to be run, so its gain at 0 Hz is not known", label(check)));
    }
    return found;
}

std::string arithmetic_name(Arithmetic arithmetic) {
    const std::string_view form = arithmetic.form == Form::df1    ? "direct form I"
                                  : arithmetic.form == Form::df2t ? "transposed direct form II"
                                                                  : "state-variable form";
    constexpr std::string_view names[] = {"float32", "float64", "Q31"};
    return fmt::format("{}, {}", names[static_cast<std::size_t>(arithmetic.precision)], form);
}

SvfSection svf_of(const ExportSection& section, Hertz sample_rate) {
    if (section.notch) return svf_of(*section.notch, sample_rate);
    const Biquad& f = section.section;
    const double at_half_rate = 1.0 - f.a1 + f.a2;
    const double g = std::sqrt((1.0 + f.a1 + f.a2) / at_half_rate);
    const double k = 2.0 * (1.0 - f.a2) / (g * at_half_rate);
    const double scale = 4.0 / at_half_rate;
    const double high = (f.b0 - f.b1 + f.b2) * scale / 4.0;
    SvfSection svf = svf_at(g, k);
    // A low-pass has no high-pass part; the difference from 0 is rounding.
    svf.m0 = std::abs(high) < 1e-12 ? 0.0 : high;
    svf.m1 = (f.b0 - f.b2) * scale / (2.0 * g) - k * svf.m0;
    svf.m2 = 1.0 - svf.m0;
    return svf;
}

Biquad biquad_of(const SvfSection& s) {
    // State space of the two integrators: s' = A s + B x, y = C s + D x.
    const double a11 = 2.0 * s.a1 - 1.0, a12 = -2.0 * s.a2, a21 = 2.0 * s.a2, a22 = 1.0 - 2.0 * s.a3;
    const double in1 = 2.0 * s.a2, in2 = 2.0 * s.a3;
    const double out1 = s.m1 * s.a1 + s.m2 * s.a2, out2 = s.m2 * (1.0 - s.a3) - s.m1 * s.a2;
    const double through = s.m0 + s.m1 * s.a2 + s.m2 * s.a3;
    const double trace = a11 + a22, determinant = a11 * a22 - a12 * a21;
    const double once = out1 * in1 + out2 * in2;
    const double twice = out1 * (a11 * in1 + a12 * in2) + out2 * (a21 * in1 + a22 * in2);
    return {through, once - through * trace, through * determinant - trace * once + twice, -trace,
            determinant};
}

LoadedSection loaded(const Biquad& section, Arithmetic arithmetic) { return {arithmetic, section, {}}; }

LoadedSection loaded(const SvfSection& section, Precision precision) {
    return {{Form::svf, precision}, biquad_of(section), section};
}

}  // namespace ripplenotch
