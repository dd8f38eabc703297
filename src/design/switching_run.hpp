// SPDX-License-Identifier: MIT
#pragma once
// The bands of a table by turns: the C of exported code (design/runtime/switching.h), which the method runs
// in double and export in the arithmetic of what it wrote.

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

/// Whether every band runs all the time, not only the one in force.
[[nodiscard]] inline bool runs_all_bands(const SwitchingDesign& design) {
    return design.transition == "parallel" || design.transition == "crossfade";
}
/// Over which outputs are blended at a switch; 0 where they are not.
[[nodiscard]] inline long crossfade_samples(const SwitchingDesign& design) {
    return design.transition == "crossfade" ? static_cast<long>(design.crossfade_samples) : 0;
}

#define RN_INLINE

template <class Real>
struct Floating {
    using rn_real = Real;
#include "design/runtime/floating.h"

    [[nodiscard]] static rn_speed speed(double deg_s) { return static_cast<Real>(deg_s); }
    [[nodiscard]] static rn_coefficient held(double value) { return static_cast<Real>(value); }
    [[nodiscard]] static std::vector<rn_coefficient> held(const SvfSection& s) {
        return {held(s.a1), held(s.a2), held(s.a3), held(s.m0), held(s.m1), held(s.m2)};
    }
};

/// Sections in the state-variable form over an arithmetic.
template <class A>
struct Svf : A {
    using A::A, A::rn_direct, A::rn_product;
    using typename A::rn_coefficient, typename A::rn_signal;
#include "design/runtime/svf.h"

    [[nodiscard]] static rn_section section(const SvfSection& svf) {
        const auto c = A::held(svf);
        return {c[0], c[1], c[2], c[3], c[4], c[5]};
    }
};

/// `S` is a form of sections.
template <class S>
class SwitchingRun : S {
    using S::RN_ALL, S::rn_fade, S::rn_left, S::rn_section_step, S::rn_settle, S::rn_times;
    using typename S::rn_real, typename S::rn_share, typename S::rn_memory;

  public:
    using typename S::rn_section, typename S::rn_signal, typename S::rn_speed;

    /// All bands have the same number of sections; at least one band and section.
    SwitchingRun(S form, std::vector<std::vector<rn_section>> bands, const std::vector<SpeedRegion>& regions,
                 const SwitchingDesign& design)
        : S(std::move(form)),
          RN_BANDS(static_cast<int>(bands.size())),
          RN_SECTIONS(static_cast<int>(bands.front().size())),
          RN_PARALLEL(runs_all_bands(design)),
          RN_CASCADES(RN_PARALLEL != 0 ? RN_BANDS : 1),
          RN_OUTPUTS(RN_PARALLEL != 0 ? RN_BANDS + 1 : 1),
          RN_REGIONS(static_cast<int>(regions.size())),
          RN_DWELL(static_cast<long>(design.dwell_samples)),
          RN_CROSSFADE(crossfade_samples(design)),
          RN_HYSTERESIS(S::speed(design.hysteresis.value())),
          rn_bands(std::move(bands)) {
        for (const SpeedRegion& region : regions)
            rn_regions.push_back({S::speed(region.to_deg_s), region.code(), S::speed(region.full_deg_s),
                                  S::speed(region.none_deg_s)});
        state_.memory.resize(static_cast<std::size_t>(RN_CASCADES),
                             std::vector<rn_memory>(rn_bands.front().size()));
        state_.leaving.resize(static_cast<std::size_t>(RN_OUTPUTS));
        outputs_.resize(state_.leaving.size());
        restart();
    }

    void restart() { rn_init(&state_); }
    /// The next output; `changed(before, unchanged)` is called where another band becomes active, with the
    /// band before, and the output without the change.
    template <class Changed>
    rn_signal next(rn_signal x, rn_speed size, const Changed& changed) {
        const int starts = state_.region < 0, before = state_.band, region = state_.region;
        rn_supervise(&state_, size);
        if (starts == 0 && state_.band != before) {
            rn_state stays = state_;
            stays.band = before;
            stays.region = region;
            changed(before, rn_filter(&stays, outputs_.data(), x, size, starts, before));
        }
        return rn_filter(&state_, outputs_.data(), x, size, starts, before);
    }
    /// The active band, counted from 0; no_candidate.
    [[nodiscard]] int band() const { return state_.band; }

  private:
    struct rn_state {
        std::vector<std::vector<rn_memory>> memory;
        std::vector<rn_share> leaving;
        int band, region;
        long since, blended;
    };
#define RN_PREVIEW
#include "design/runtime/cascade.h"
#include "design/runtime/switching.h"
#undef RN_PREVIEW

    int RN_BANDS, RN_SECTIONS, RN_PARALLEL, RN_CASCADES, RN_OUTPUTS, RN_REGIONS;
    long RN_DWELL, RN_CROSSFADE;
    rn_speed RN_HYSTERESIS;
    std::vector<std::vector<rn_section>> rn_bands;
    std::vector<rn_region> rn_regions;
    rn_state state_{};
    std::vector<rn_signal> outputs_;
};

#undef RN_INLINE

}  // namespace ripplenotch
