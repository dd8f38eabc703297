// SPDX-License-Identifier: MIT
#include "export/code/switching_code.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "design/switching_run.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double full_scale = 2147483648.0;  // one more than the largest word
constexpr std::size_t samples_a_region = 6;
constexpr std::size_t max_regions_visited = 24;

#define RN_INLINE

struct Fixed {
#include "design/runtime/fixed.h"

    explicit Fixed(const Arithmetic& arithmetic) : RN_FRACTION(fraction_bits(arithmetic)) {}
    [[nodiscard]] static rn_speed speed(double deg_s) {
        return std::isinf(deg_s) ? 0 : static_cast<rn_speed>(std::llround(deg_s * fixed_speed_steps));
    }
    [[nodiscard]] static std::vector<rn_coefficient> held(const SvfSection& section) {
        std::vector<rn_coefficient> found;
        for (const FixedCoefficient& c : fixed_coefficients(section))
            found.push_back({c.mantissa, static_cast<std::int16_t>(c.shift)});
        return found;
    }

    int RN_FRACTION;
};

// Forms of a section that floating point alone has.

template <class Real>
struct Df1 : Floating<Real> {
    using typename Floating<Real>::rn_coefficient, typename Floating<Real>::rn_signal;
#include "design/runtime/df1.h"
};
template <class Real>
struct Df2t : Floating<Real> {
    using typename Floating<Real>::rn_coefficient, typename Floating<Real>::rn_signal;
#include "design/runtime/df2t.h"
};

#undef RN_INLINE

// A form of sections in an arithmetic, with torques in double.
template <class S>
struct Kind {
    S form;
    Arithmetic arithmetic;

    [[nodiscard]] auto in(double torque_nm) {
        if constexpr (std::is_same_v<S, Svf<Fixed>>)
            return form.rn_enter(static_cast<std::int32_t>(fixed_word(torque_nm, arithmetic)));
        else
            return form.rn_enter(static_cast<typename S::rn_real>(torque_nm));
    }
    [[nodiscard]] double out(typename S::rn_signal x) {
        if constexpr (std::is_same_v<S, Svf<Fixed>>)
            return fixed_torque_nm(form.rn_leave(x), arithmetic);
        else
            return static_cast<double>(form.rn_leave(x));
    }
    [[nodiscard]] static typename S::rn_section section(const LoadedSection& section) {
        const Biquad& f = section.biquad;
        if constexpr (requires { S::section(section.svf); })
            return S::section(section.svf);
        else
            return {S::held(f.b0), S::held(f.b1), S::held(f.b2), S::held(f.a1), S::held(f.a2)};
    }
};

template <class Work>
auto in_arithmetic(const Arithmetic& arithmetic, const Work& work) {
    if (is_fixed(arithmetic.precision)) return work(Kind<Svf<Fixed>>{Svf<Fixed>(arithmetic), arithmetic});
    const auto in_form = [&]<class Real>(Real) {
        if (arithmetic.form == Form::svf) return work(Kind<Svf<Floating<Real>>>{{}, arithmetic});
        if (arithmetic.form == Form::df1) return work(Kind<Df1<Real>>{{}, arithmetic});
        return work(Kind<Df2t<Real>>{{}, arithmetic});
    };
    return arithmetic.precision == Precision::float32 ? in_form(0.0F) : in_form(0.0);
}

// A speed inside the region that a float holds exactly; the upper edge belongs to the region.
double speed_in(const std::vector<SpeedRegion>& regions, std::size_t at) {
    const double from = at == 0 ? 0.0 : regions[at - 1].to_deg_s;
    const double to = regions[at].to_deg_s;
    const double middle =
        std::isinf(to) ? std::round(1.25 * from) + 1.0 : std::round(4.0 * (from + to)) / 8.0;
    return middle > from && middle <= to ? middle : static_cast<double>(static_cast<float>(to));
}

/// Sums of the magnitudes of the impulse responses of everything inside of a cascade: what a torque of 1 can
/// make of each signal at most.
double largest_signal(const ExportBand& band, Hertz sample_rate) {
    constexpr std::size_t longest = 4'000'000;  // chosen, not derived: bounds the time
    constexpr double dies_away_to = 1e-9;       // share of the largest sum that a block still adds
    std::vector<SvfSection> sections;
    for (const ExportSection& section : band.sections) sections.push_back(svf_of(section, sample_rate));
    std::vector<std::array<double, 2>> states(sections.size());
    std::vector<std::array<double, 5>> sums(sections.size());
    double largest = 1.0, before = 0.0;
    for (std::size_t k = 0; k < longest; ++k) {
        double x = k == 0 ? 1.0 : 0.0;
        for (std::size_t i = 0; i < sections.size(); ++i) {
            const SvfSection& s = sections[i];
            auto& [s1, s2] = states[i];
            const double v3 = x - s2, v1 = s.a1 * s1 + s.a2 * v3, v2 = s2 + s.a2 * s1 + s.a3 * v3;
            s1 = v1 + v1 - s1;
            s2 = v2 + v2 - s2;
            x = s.m0 * x + s.m1 * v1 + s.m2 * v2;
            const std::array now = {v3, s1, s2, v1, x};
            for (std::size_t j = 0; j < now.size(); ++j) {
                sums[i][j] += std::abs(now[j]);
                largest = std::max(largest, sums[i][j]);
            }
        }
        if (k % 4096 != 4095) continue;
        double all = 0.0;
        for (const auto& one : sums) all += one[0] + one[1] + one[2] + one[3] + one[4];
        if (all - before < dies_away_to * all) break;
        before = all;
    }
    return largest;
}

}  // namespace

std::vector<SpeedRegion> switching_regions(const FilterSet& filters) {
    if (!filters.by_speed()) return {{-infinity, infinity, 0}};
    std::vector<std::pair<DegPerSec, DegPerSec>> edges;
    for (const ExportBand& band : filters.bands) edges.emplace_back(band.from, band.to);
    return speed_regions(edges, filters.switching.below, filters.switching.above);
}

FixedCoefficient FixedCoefficient::of(double value) {
    constexpr int bits = 31;
    if (value == 0.0) return {0, bits + Fixed::RN_UNUSED};
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);  // 0.5 <= |fraction| < 1
    double mantissa = std::nearbyint(std::ldexp(fraction, bits));
    if (std::abs(mantissa) >= std::ldexp(1.0, bits)) {
        mantissa /= 2.0;
        ++exponent;
    }
    return {static_cast<std::int32_t>(mantissa), bits - exponent};
}

double FixedCoefficient::value() const { return std::ldexp(static_cast<double>(mantissa), -shift); }

std::vector<FixedCoefficient> fixed_coefficients(const SvfSection& s) {
    std::vector<FixedCoefficient> found;
    for (const double value : {s.a1, s.a2, s.a3, s.m0 - 1.0, s.m1, s.m2})
        found.push_back(FixedCoefficient::of(value));
    return found;
}

int fraction_bits(const Arithmetic& arithmetic) { return 16 - arithmetic.headroom_bits; }

std::int64_t fixed_word(double torque_nm, const Arithmetic& arithmetic) {
    return static_cast<std::int64_t>(std::clamp(
        std::nearbyint(torque_nm / arithmetic.full_scale_nm * full_scale), -full_scale, full_scale - 1.0));
}

double fixed_torque_nm(std::int64_t word, const Arithmetic& arithmetic) {
    return static_cast<double>(word) / full_scale * arithmetic.full_scale_nm;
}

int headroom_bits(const FilterSet& filters) {
    double largest = 1.0;
    for (const ExportBand& band : filters.bands)
        largest = std::max(largest, largest_signal(band, filters.sample_rate));
    const int bits = static_cast<int>(std::ceil(portable::log2(largest))) + 1;
    constexpr int most = 12;  // of 16: more would leave fewer digits than the torque has
    if (bits > most)
        raise<UsageError>(
            "in fixed point these filters need {} bits above the torque, and there are {}; use a lower Q or "
            "precision=float",
            bits, most);
    return bits;
}

void run_section(const LoadedSection& section, std::span<const double> in, std::span<double> out) {
    in_arithmetic(section.arithmetic, [&](auto kind) {
        const auto held = kind.section(section);
        typename decltype(kind.form)::rn_memory memory{};
        std::transform(in.begin(), in.end(), out.begin(), [&](double x) {
            return kind.out(kind.form.rn_section_step(&held, &memory, kind.in(x)));
        });
    });
}

GoldenVector golden_vector(const FilterSet& filters, const LoadedFilters& loaded) {
    const Arithmetic arithmetic = loaded.bands.front().front().arithmetic;
    const auto regions = switching_regions(filters);
    std::vector<std::size_t> visits;
    const std::size_t stride = (regions.size() + max_regions_visited - 1) / max_regions_visited;
    for (std::size_t r = 0; r < regions.size(); r += stride) visits.push_back(r);
    if (visits.back() != regions.size() - 1) visits.push_back(regions.size() - 1);
    for (std::size_t up = visits.size(); up-- > 0;) visits.push_back(visits[up]);

    GoldenVector golden;
    const double scale = is_fixed(arithmetic.precision) ? arithmetic.full_scale_nm / 16.0 : 1.0;
    for (std::size_t v = 0; v < visits.size(); ++v) {
        // Backward on the way down: the sign of the speed must not matter.
        const double speed = speed_in(regions, visits[v]) * (2 * v < visits.size() ? 1.0 : -1.0);
        for (std::size_t i = 0; i < samples_a_region; ++i) {
            const std::size_t k = golden.torque_nm.size();
            golden.speed_deg_s.push_back(speed);
            golden.torque_nm.push_back(scale * (4.0 + (static_cast<double>(k * 37 % 64) - 32.0) / 16.0));
        }
    }
    const auto run_in = [&](const Arithmetic& target) {
        std::vector<double> out;
        in_arithmetic(target, [&](auto kind) {
            using Sections = decltype(kind.form);
            std::vector<std::vector<typename Sections::rn_section>> bands;
            for (const auto& band : loaded.bands) {
                auto& sections = bands.emplace_back();
                for (const LoadedSection& section : band) sections.push_back(kind.section(section));
            }
            SwitchingRun<Sections> run(kind.form, std::move(bands), regions, filters.switching);
            for (std::size_t k = 0; k < golden.torque_nm.size(); ++k)
                out.push_back(
                    kind.out(run.next(kind.in(golden.torque_nm[k]),
                                      Sections::speed(std::abs(golden.speed_deg_s[k])), [](int, auto) {})));
        });
        return out;
    };
    golden.expected_nm = run_in(arithmetic);
    if (!is_fixed(arithmetic.precision)) return golden;
    const std::vector<double> exact = run_in({Form::svf, Precision::float64});
    double squares = 0.0;
    for (std::size_t k = 0; k < exact.size(); ++k)
        squares += (golden.expected_nm[k] - exact[k]) * (golden.expected_nm[k] - exact[k]);
    golden.rounding_rms_nm = std::sqrt(squares / static_cast<double>(exact.size()));
    return golden;
}

}  // namespace ripplenotch
