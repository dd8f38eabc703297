// SPDX-License-Identifier: MIT
#pragma once
// Methods as `compare` takes them, and the paper's table.

#include <memory>
#include <string>
#include <utility>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch::testing {

inline std::shared_ptr<const CandidateTable> paper_table() {
    using namespace literals;
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0), Order(2.0)};
    spec.sample_rate = 1000_Hz;
    spec.bands = bands_by_spacing({18_deg_s, 180_deg_s}, 18_deg_s);
    return std::make_shared<const CandidateTable>(CandidateTable::design(spec));
}

inline Contender contender(const std::string& text, std::shared_ptr<const CandidateTable> table = nullptr) {
    return make_contender(parse_spec(text), std::move(table));
}

}  // namespace ripplenotch::testing
