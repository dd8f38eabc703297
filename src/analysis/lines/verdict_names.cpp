// SPDX-License-Identifier: MIT
#include <array>
#include <utility>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {
namespace {

template <class Value>
using Named = std::pair<Value, std::string_view>;

constexpr std::array findings{Named<RippleFinding>{RippleFinding::ratio, "ratio"},
                              Named<RippleFinding>{RippleFinding::orders, "orders"},
                              Named<RippleFinding>{RippleFinding::one_speed, "one speed"},
                              Named<RippleFinding>{RippleFinding::nothing, "nothing"},
                              Named<RippleFinding>{RippleFinding::too_little, "too little motion"}};
constexpr std::array doubt_reasons{Named<DoubtReason>{DoubtReason::clock, "clock"},
                                   Named<DoubtReason>{DoubtReason::unit, "unit"}};
constexpr std::array abouts{Named<Disagreement::About>{Disagreement::About::ratio, "gear ratio"},
                            Named<Disagreement::About>{Disagreement::About::amplitude, "amplitude"},
                            Named<Disagreement::About>{Disagreement::About::phase, "phase"}};
constexpr std::array ways{Named<LineEvidence>{LineEvidence::none, ""},
                          Named<LineEvidence>{LineEvidence::stretches, "steady stretches"},
                          Named<LineEvidence>{LineEvidence::sweeps, "order spectrum"},
                          Named<LineEvidence>{LineEvidence::both, "steady stretches and order spectrum"}};

template <class Table, class Value>
std::string_view name_in(const Table& table, Value value) {
    for (const auto& [one, name] : table) {
        if (one == value) return name;
    }
    return "";
}

template <class Value, class Table>
std::optional<Value> value_in(const Table& table, std::string_view name) {
    for (const auto& [value, one] : table) {
        if (one == name) return value;
    }
    return std::nullopt;
}

}  // namespace

std::string_view finding_name(RippleFinding finding) { return name_in(findings, finding); }
std::optional<RippleFinding> finding_of(std::string_view name) {
    return value_in<RippleFinding>(findings, name);
}
std::string_view doubt_name(DoubtReason reason) { return name_in(doubt_reasons, reason); }
std::optional<DoubtReason> doubt_of(std::string_view name) {
    return value_in<DoubtReason>(doubt_reasons, name);
}
std::string_view about_name(Disagreement::About about) { return name_in(abouts, about); }
std::optional<Disagreement::About> about_of(std::string_view name) {
    return value_in<Disagreement::About>(abouts, name);
}
std::string_view evidence_name(LineEvidence evidence) { return name_in(ways, evidence); }
std::optional<LineEvidence> evidence_of(std::string_view name) { return value_in<LineEvidence>(ways, name); }

}  // namespace ripplenotch
