// SPDX-License-Identifier: MIT
#include "export/code/switching_code.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double full_scale = 2147483648.0;  // one more than the largest word
constexpr std::int64_t largest_word = 2147483647;
constexpr std::size_t samples_a_region = 6;
constexpr std::size_t max_regions_visited = 24;

template <class Real>
struct Floating {
    using Signal = Real;
    using Speed = Real;
    using Coefficient = Real;
    static constexpr bool fixed = false;

    explicit Floating(const Arithmetic&) {}
    [[nodiscard]] Signal in(double torque_nm) const { return static_cast<Real>(torque_nm); }
    [[nodiscard]] double out(Signal torque) const { return static_cast<double>(torque); }
    [[nodiscard]] static Speed speed(double deg_s) { return static_cast<Real>(deg_s); }
    [[nodiscard]] static std::array<Coefficient, 6> coefficients(const LoadedSection& section) {
        const Biquad& f = section.biquad;
        const SvfSection& s = section.svf;
        const std::array<double, 6> values = section.arithmetic.form == Form::svf
                                                 ? std::array{s.a1, s.a2, s.a3, s.m0, s.m1, s.m2}
                                                 : std::array{f.b0, f.b1, f.b2, f.a1, f.a2, 0.0};
        std::array<Coefficient, 6> found{};
        std::transform(values.begin(), values.end(), found.begin(),
                       [](double value) { return static_cast<Real>(value); });
        return found;
    }
    [[nodiscard]] static Signal product(Coefficient c, Signal x) { return c * x; }
    /// Share of a region in which the filter fades, 0 to 1, and x times a share.
    [[nodiscard]] static Real share(Speed speed, Speed full, Speed none) {
        const Real share = (speed - none) / (full - none);
        return share < Real{} ? Real{} : share > Real{1} ? Real{1} : share;
    }
    [[nodiscard]] static Real left(std::size_t step, std::size_t steps) {
        return Real{1} - static_cast<Real>(step) / static_cast<Real>(steps);
    }
    [[nodiscard]] static Real all() { return Real{1}; }
    [[nodiscard]] static Signal times(Signal x, Real share) { return share * x; }
    using Share = Real;
};

struct Fixed {
    using Signal = std::int64_t;
    using Speed = std::int64_t;
    using Coefficient = FixedCoefficient;
    using Share = std::int32_t;  ///< 32768 is all
    static constexpr bool fixed = true;

    explicit Fixed(const Arithmetic& arithmetic) : arithmetic_(arithmetic) {}
    [[nodiscard]] Signal in(double torque_nm) const {
        return fixed_word(torque_nm, arithmetic_) * (std::int64_t{1} << fraction_bits(arithmetic_));
    }
    [[nodiscard]] double out(Signal torque) const {
        const int bits = fraction_bits(arithmetic_);
        const std::int64_t word = (torque + (std::int64_t{1} << (bits - 1))) >> bits;
        return fixed_torque_nm(std::clamp(word, -largest_word - 1, largest_word), arithmetic_);
    }
    [[nodiscard]] static Speed speed(double deg_s) {
        return std::isinf(deg_s) ? 0 : std::llround(deg_s * fixed_speed_steps);
    }
    [[nodiscard]] static std::array<Coefficient, 6> coefficients(const LoadedSection& section) {
        std::array<Coefficient, 6> found{};
        const auto values = fixed_coefficients(section.svf);
        std::copy(values.begin(), values.end(), found.begin());
        return found;
    }
    [[nodiscard]] static Signal product(const Coefficient& c, Signal x) {
        const int shift = c.shift - unused_bits;
        return (c.mantissa * (x >> unused_bits) + (std::int64_t{1} << (shift - 1))) >> shift;
    }
    [[nodiscard]] static Share share(Speed speed, Speed full, Speed none) {
        const std::int64_t share = (speed - none) * 32768 / (full - none);
        return static_cast<Share>(std::clamp<std::int64_t>(share, 0, 32768));
    }
    [[nodiscard]] static Share left(std::size_t step, std::size_t steps) {
        return static_cast<Share>(static_cast<std::int64_t>(steps - step) * 32768 /
                                  static_cast<std::int64_t>(steps));
    }
    [[nodiscard]] static Share all() { return 32768; }
    [[nodiscard]] static Signal times(Signal x, Share share) {
        return (x >> 15) * share + (((x & 32767) * share) >> 15);
    }

  private:
    Arithmetic arithmetic_;
};

template <class A>
struct SectionRun {
    using Signal = typename A::Signal;
    using Memory = std::array<Signal, 4>;

    Form form;
    std::array<typename A::Coefficient, 6> c;

    explicit SectionRun(const LoadedSection& section)
        : form(section.arithmetic.form), c(A::coefficients(section)) {}
    /// As if x had been there for ever.
    [[nodiscard]] Memory settled(Signal x) const {
        if (form == Form::df1) return {x, x, x, x};
        if (form == Form::svf) return {Signal{}, x};
        if constexpr (!A::fixed) {
            const Signal s2 = (c[2] - c[4]) * x;
            return {(c[1] - c[3]) * x + s2, s2};
        }
        return {};
    }
    Signal step(Memory& m, Signal x) const {
        const auto times = [this](std::size_t i, Signal value) { return A::product(c[i], value); };
        if (form == Form::svf) {
            const Signal v3 = x - m[1];
            const Signal v1 = times(0, m[0]) + times(1, v3);
            const Signal v2 = m[1] + times(1, m[0]) + times(2, v3);
            m[0] = v1 + v1 - m[0];
            m[1] = v2 + v2 - m[1];
            const Signal y = times(3, x) + times(4, v1) + times(5, v2);
            return A::fixed ? x + y : y;
        }
        if constexpr (!A::fixed) {
            if (form == Form::df1) {
                const Signal y = c[0] * x + c[1] * m[0] + c[2] * m[1] - c[3] * m[2] - c[4] * m[3];
                m = {x, m[0], y, m[2]};
                return y;
            }
            const Signal y = c[0] * x + m[0];
            m[0] = c[1] * x - c[3] * y + m[1];
            m[1] = c[2] * x - c[4] * y;
            return y;
        }
        return x;
    }
};

/// One cascade whose memory stays while its coefficients change, or all of them side by side.
template <class A>
class SwitchingRun {
  public:
    using Signal = typename A::Signal;
    using Speed = typename A::Speed;
    using Share = typename A::Share;

    SwitchingRun(const FilterSet& filters, const LoadedFilters& loaded)
        : arithmetic_(loaded.bands.front().front().arithmetic),
          regions_(switching_regions(filters)),
          design_(filters.switching),
          parallel_(runs_all_bands(design_)),
          blend_(design_.transition == "crossfade" ? design_.crossfade_samples : 0),
          hysteresis_(A::speed(design_.hysteresis.value())) {
        for (const auto& band : loaded.bands) {
            auto& sections = bands_.emplace_back();
            for (const LoadedSection& section : band) sections.emplace_back(section);
        }
        memories_.resize(parallel_ ? bands_.size() : 1, Memories(bands_.front().size()));
        leaving_.resize(bands_.size() + 1);
        outputs_.resize(bands_.size() + 1);
    }

    double step(double torque_nm, double speed_deg_s) {
        return arithmetic_.out(next(arithmetic_.in(torque_nm), A::speed(std::abs(speed_deg_s))));
    }

  private:
    using Memories = std::vector<typename SectionRun<A>::Memory>;

    void settle(std::size_t memory, std::size_t band, Signal torque) {
        for (std::size_t i = 0; i < bands_[band].size(); ++i)
            memories_[memory][i] = bands_[band][i].settled(torque);
    }
    Signal run(std::size_t memory, std::size_t band, Signal torque) {
        for (std::size_t i = 0; i < bands_[band].size(); ++i)
            torque = bands_[band][i].step(memories_[memory][i], torque);
        return torque;
    }

    // The supervisor: true where another filter comes into force.
    bool supervise(Speed speed) {
        const bool first = region_ < 0;
        if (!first) {
            const auto at = static_cast<std::size_t>(region_);
            const Speed from = at > 0 ? A::speed(regions_[at - 1].to_deg_s) : Speed{};
            // Written so that a speed that is not a number is outside.
            if (speed > from - hysteresis_ &&
                (at + 1 == regions_.size() || speed <= A::speed(regions_[at].to_deg_s) + hysteresis_)) {
                since_ = std::min(since_ + 1, design_.dwell_samples);
                return false;
            }
        }
        std::size_t next = 0;
        while (next + 1 < regions_.size() && speed > A::speed(regions_[next].to_deg_s)) ++next;
        const int band = regions_[next].band == region_holds ? band_ : regions_[next].band;
        const bool changes = band != band_;
        if (!first && changes && since_ < design_.dwell_samples) {
            ++since_;
            return false;
        }
        since_ = first     ? design_.dwell_samples
                 : changes ? std::min<std::size_t>(1, design_.dwell_samples)
                           : std::min(since_ + 1, design_.dwell_samples);
        region_ = static_cast<int>(next);
        band_ = band;
        return changes && !first;
    }

    // The mixture in force becomes the start of a new blend.
    void blend_from(int before) {
        Share rest = A::all();
        const Share remaining = blending_ ? A::left(blended_, blend_) : Share{};
        for (Share& share : leaving_) {
            share = static_cast<Share>(A::fixed ? A::times(share, remaining) : share * remaining);
            rest = static_cast<Share>(rest - share);
        }
        leaving_[static_cast<std::size_t>(before + 1)] =
            static_cast<Share>(leaving_[static_cast<std::size_t>(before + 1)] + rest);
        leaving_[static_cast<std::size_t>(band_ + 1)] = Share{};
        blending_ = true;
        blended_ = 0;
    }

    Signal next(Signal torque, Speed speed) {
        const int before = band_;
        const bool first = region_ < 0, changed = supervise(speed);
        Signal filtered = torque;
        if (parallel_) {
            if (first)
                for (std::size_t b = 0; b < bands_.size(); ++b) settle(b, b, torque);
            outputs_[0] = torque;
            for (std::size_t b = 0; b < bands_.size(); ++b) outputs_[b + 1] = run(b, b, torque);
            filtered = outputs_[static_cast<std::size_t>(band_ + 1)];
            if (changed && blend_ > 0) blend_from(before);
            if (blending_) {
                const Signal target = filtered;
                Signal sum{};
                ++blended_;
                for (std::size_t i = 0; i < leaving_.size(); ++i)
                    sum += A::times(outputs_[i] - target, leaving_[i]);
                filtered = target + A::times(sum, A::left(blended_, blend_));
                if (blended_ >= blend_) {
                    blending_ = false;
                    std::fill(leaving_.begin(), leaving_.end(), Share{});
                }
            }
        } else if (band_ != region_passes) {
            const auto band = static_cast<std::size_t>(band_);
            if (before == region_passes) settle(0, band, torque);
            filtered = run(0, band, torque);
        }
        const SwitchingRegion& region = regions_[static_cast<std::size_t>(region_)];
        const Speed full = A::speed(region.full_deg_s), none = A::speed(region.none_deg_s);
        if (full == none) return filtered;
        return torque + A::times(filtered - torque, A::share(speed, full, none));
    }

    A arithmetic_;
    std::vector<SwitchingRegion> regions_;
    SwitchingDesign design_;
    bool parallel_;
    std::size_t blend_;
    Speed hysteresis_;
    std::vector<std::vector<SectionRun<A>>> bands_;
    std::vector<Memories> memories_;
    std::vector<Share> leaving_;   ///< by band, the torque first: shares at the start of a blend
    std::vector<Signal> outputs_;  ///< the same places
    std::size_t since_ = 0, blended_ = 0;
    bool blending_ = false;
    int region_ = -1, band_ = region_passes;
};

template <class Work>
auto in_arithmetic(Precision precision, const Work& work) {
    if (is_fixed(precision)) return work(static_cast<Fixed*>(nullptr));
    if (precision == Precision::float32) return work(static_cast<Floating<float>*>(nullptr));
    return work(static_cast<Floating<double>*>(nullptr));
}

// A speed inside the region that a float holds exactly; the upper edge belongs to the region.
double speed_in(const std::vector<SwitchingRegion>& regions, std::size_t at) {
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

bool runs_all_bands(const SwitchingDesign& design) {
    return design.transition == "parallel" || design.transition == "crossfade";
}

std::vector<SwitchingRegion> switching_regions(const FilterSet& filters) {
    if (!filters.by_speed()) return {{infinity, 0}};
    std::vector<std::pair<DegPerSec, DegPerSec>> edges;
    for (const ExportBand& band : filters.bands) edges.emplace_back(band.from, band.to);
    std::vector<SwitchingRegion> regions;
    for (const SpeedRegion& region : speed_regions(edges, filters.switching.below, filters.switching.above)) {
        const int band = region.holds                       ? region_holds
                         : region.candidate == no_candidate ? region_passes
                                                            : region.candidate;
        regions.push_back({region.to_deg_s, band, region.full_deg_s, region.none_deg_s});
    }
    return regions;
}

FixedCoefficient FixedCoefficient::of(double value) {
    constexpr int bits = 31;
    if (value == 0.0) return {0, bits + unused_bits};
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
    in_arithmetic(section.arithmetic.precision, [&](auto* kind) {
        using A = std::remove_pointer_t<decltype(kind)>;
        const A arithmetic(section.arithmetic);
        const SectionRun<A> run(section);
        typename SectionRun<A>::Memory memory{};
        std::transform(in.begin(), in.end(), out.begin(),
                       [&](double x) { return arithmetic.out(run.step(memory, arithmetic.in(x))); });
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
    const auto run_in = [&](Precision precision) {
        std::vector<double> out;
        in_arithmetic(precision, [&](auto* kind) {
            SwitchingRun<std::remove_pointer_t<decltype(kind)>> run(filters, loaded);
            for (std::size_t k = 0; k < golden.torque_nm.size(); ++k)
                out.push_back(run.step(golden.torque_nm[k], golden.speed_deg_s[k]));
        });
        return out;
    };
    golden.expected_nm = run_in(arithmetic.precision);
    if (!is_fixed(arithmetic.precision)) return golden;
    const std::vector<double> exact = run_in(Precision::float64);
    double squares = 0.0;
    for (std::size_t k = 0; k < exact.size(); ++k)
        squares += (golden.expected_nm[k] - exact[k]) * (golden.expected_nm[k] - exact[k]);
    golden.rounding_rms_nm = std::sqrt(squares / static_cast<double>(exact.size()));
    return golden;
}

}  // namespace ripplenotch
