// SPDX-License-Identifier: MIT
#include "model/fit/weighing.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/dot.hpp"

namespace ripplenotch {
namespace {

// A nuisance of which less than this part lies outside the others brings rounding noise alone.
constexpr double not_new = 1e-9;

double length_of(const std::vector<double>& column) {
    return std::sqrt(dot(column.data(), column.data(), column.size()));
}

}  // namespace

Weighing::Weighing(std::size_t samples, std::span<const unsigned char> use, std::span<const double> color,
                   std::span<const unsigned char> valid)
    : color_(color.begin(), color.end()) {
    if (valid.empty()) valid = use;
    for (std::size_t k = 0; k < samples; ++k) {
        if (!valid.empty() && valid[k] == 0) {
            if (gaps_.empty() || gaps_.back().first + gaps_.back().count != k) gaps_.push_back({k, 0});
            ++gaps_.back().count;
        }
        if (k < color_.size() || (!use.empty() && use[k] == 0)) continue;
        if (rows_.empty() || rows_.back() + 1 != k) runs_.push_back({k, 0});
        ++runs_.back().count;
        rows_.push_back(k);
    }
}

std::vector<double> Weighing::bridged(std::span<const double> torque_nm) const {
    std::vector<double> whole(torque_nm.begin(), torque_nm.end());
    for (const Run& gap : gaps_) {
        const std::size_t end = gap.first + gap.count;
        const bool before = gap.first > 0, after = end < whole.size();
        const double left = before ? whole[gap.first - 1] : (after ? whole[end] : 0.0);
        const double right = after ? whole[end] : left;
        for (std::size_t k = gap.first; k < end; ++k) {
            const double part = static_cast<double>(k - gap.first + 1) / static_cast<double>(gap.count + 1);
            whole[k] = left + part * (right - left);
        }
    }
    return whole;
}

void Weighing::whiten(std::span<const double> torque_nm, double* white) const {
    std::vector<double> whole;
    if (!gaps_.empty() && !color_.empty()) torque_nm = whole = bridged(torque_nm);
    for (const Run& run : runs_) {
        prediction_errors(torque_nm.data() + run.first, run.count, color_.data(), color_.size(), white);
        white += run.count;
    }
    std::fill_n(white, bounded_, 0.0);
}

std::vector<double> Weighing::whitened(std::span<const double> torque_nm) const {
    std::vector<double> white(size());
    whiten(torque_nm, white.data());
    return white;
}

void Weighing::weigh(std::span<const double> torque_nm, double* weighed) const {
    whiten(torque_nm, weighed);
    for (std::size_t first = 0; first < basis_.size(); first += size()) {
        const double* const nuisance = basis_.data() + first;
        add_scaled(-dot(nuisance, weighed, size()), nuisance, weighed, size());
    }
}

std::vector<double> Weighing::operator()(std::span<const double> torque_nm) const {
    std::vector<double> weighed(size());
    weigh(torque_nm, weighed.data());
    return weighed;
}

void Weighing::set_nuisance(const std::vector<Nuisance>& nuisance, double noise_nm) {
    basis_.clear();
    bounded_ = static_cast<std::size_t>(std::count_if(
        nuisance.begin(), nuisance.end(), [](const Nuisance& entry) { return entry.usual_size > 0.0; }));
    const std::size_t n = size();
    std::size_t bound = rows_.size();
    for (const Nuisance& entry : nuisance) {
        std::vector<double> column = whitened(entry.torque_nm);
        if (entry.usual_size > 0.0) column[bound++] = noise_nm / entry.usual_size;
        const double length = length_of(column);
        for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan, Parlett)
            for (std::size_t first = 0; first < basis_.size(); first += n) {
                const double* const other = basis_.data() + first;
                add_scaled(-dot(other, column.data(), n), other, column.data(), n);
            }
        }
        const double left = length_of(column);
        if (!(left > not_new * length)) continue;
        for (double& value : column) value /= left;
        basis_.insert(basis_.end(), column.begin(), column.end());
    }
}

}  // namespace ripplenotch
