// SPDX-License-Identifier: MIT
#include "export/run/bank.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "export/run/structure.hpp"
#include "ripplenotch/design/speed_regions.hpp"

namespace ripplenotch {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t samples_a_region = 6;
constexpr std::size_t most_regions_visited = 24;

template <class Real, template <class> class Structure>
class Bank {
  public:
    Bank(const std::vector<BankRegion>& regions, const LoadedFilters& filters) : regions_(regions) {
        for (const auto& band : filters.bands) {
            auto& sections = bands_.emplace_back();
            for (const LoadedSection& section : band)
                sections.push_back(Structure<Real>::coefficients(section));
        }
        states_.resize(bands_.front().size());
    }

    Real step(Real torque, Real velocity) {
        const Real speed = velocity < Real{} ? -velocity : velocity;
        std::size_t at = 0;
        while (at + 1 < regions_.size() && speed > static_cast<Real>(regions_[at].to_deg_s)) ++at;
        const BankRegion& region = regions_[at];
        const int band = region.band == region_holds ? band_ : region.band;
        if (band != region_passes && band_ == region_passes) {
            for (std::size_t i = 0; i < states_.size(); ++i)
                states_[i] = Structure<Real>::settled(bands_[static_cast<std::size_t>(band)][i], torque);
        }
        band_ = band;
        if (band == region_passes) return torque;
        Real filtered = torque;
        for (std::size_t i = 0; i < states_.size(); ++i)
            filtered = Structure<Real>::step(bands_[static_cast<std::size_t>(band)][i], states_[i], filtered);
        const Real full = static_cast<Real>(region.full_deg_s), none = static_cast<Real>(region.none_deg_s);
        if (full == none) return filtered;
        Real share = (speed - none) / (full - none);
        share = share < Real{} ? Real{} : share > Real{1} ? Real{1} : share;
        return torque + share * (filtered - torque);
    }

  private:
    const std::vector<BankRegion>& regions_;
    std::vector<std::vector<typename Structure<Real>::Coefficients>> bands_;
    std::vector<typename Structure<Real>::State> states_;
    int band_ = region_passes;
};

// A speed inside the region that a float holds exactly; the upper edge belongs to the region.
double speed_in(const std::vector<BankRegion>& regions, std::size_t at) {
    const double from = at == 0 ? 0.0 : regions[at - 1].to_deg_s;
    const double to = regions[at].to_deg_s;
    const double middle =
        std::isinf(to) ? std::round(1.25 * from) + 1.0 : std::round(4.0 * (from + to)) / 8.0;
    return middle > from && middle <= to ? middle : static_cast<double>(static_cast<float>(to));
}

template <class Real, template <class> class Structure>
void run_bank(GoldenVector& golden, const std::vector<BankRegion>& regions, const LoadedFilters& filters) {
    Bank<Real, Structure> bank(regions, filters);
    for (std::size_t k = 0; k < golden.torque_nm.size(); ++k) {
        golden.expected_nm.push_back(static_cast<double>(
            bank.step(static_cast<Real>(golden.torque_nm[k]), static_cast<Real>(golden.speed_deg_s[k]))));
    }
}

template <class Real>
void run_bank_in(GoldenVector& golden, const std::vector<BankRegion>& regions, const LoadedFilters& filters,
                 Form form) {
    switch (form) {
        case Form::df1:
            return run_bank<Real, DirectForm1>(golden, regions, filters);
        case Form::df2t:
            return run_bank<Real, TransposedForm2>(golden, regions, filters);
        case Form::svf:
            return run_bank<Real, StateVariable>(golden, regions, filters);
    }
}

}  // namespace

std::vector<BankRegion> bank_regions(const FilterSet& filters) {
    if (!filters.by_speed()) return {{infinity, 0}};
    std::vector<std::pair<DegPerSec, DegPerSec>> edges;
    for (const ExportBand& band : filters.bands) edges.emplace_back(band.from, band.to);
    std::vector<BankRegion> regions;
    for (const SpeedRegion& region : speed_regions(edges, filters.below, filters.above)) {
        const int band = region.holds                       ? region_holds
                         : region.candidate == no_candidate ? region_passes
                                                            : region.candidate;
        regions.push_back({region.to_deg_s, band, region.full_deg_s, region.none_deg_s});
    }
    return regions;
}

GoldenVector golden_vector(const std::vector<BankRegion>& regions, const LoadedFilters& filters,
                           Arithmetic arithmetic) {
    std::vector<std::size_t> visits;
    const std::size_t stride = (regions.size() + most_regions_visited - 1) / most_regions_visited;
    for (std::size_t r = 0; r < regions.size(); r += stride) visits.push_back(r);
    if (visits.back() != regions.size() - 1) visits.push_back(regions.size() - 1);
    for (std::size_t up = visits.size(); up-- > 0;) visits.push_back(visits[up]);

    GoldenVector golden;
    for (std::size_t v = 0; v < visits.size(); ++v) {
        // Backward on the way down: the sign of the speed must not matter.
        const double speed = speed_in(regions, visits[v]) * (2 * v < visits.size() ? 1.0 : -1.0);
        for (std::size_t i = 0; i < samples_a_region; ++i) {
            const std::size_t k = golden.torque_nm.size();
            golden.speed_deg_s.push_back(speed);
            golden.torque_nm.push_back(4.0 + (static_cast<double>(k * 37 % 64) - 32.0) / 16.0);
        }
    }
    if (arithmetic.precision == Precision::float32) {
        run_bank_in<float>(golden, regions, filters, arithmetic.form);
    } else {
        run_bank_in<double>(golden, regions, filters, arithmetic.form);
    }
    return golden;
}

}  // namespace ripplenotch
