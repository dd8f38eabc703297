// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/contender.hpp"

#include <fmt/format.h>

namespace ripplenotch {

std::unique_ptr<CausalFilter> Contender::start(Hertz sample_rate) const {
    return method->start(settings, sample_rate, table.get());
}

std::unique_ptr<CausalFilter> Contender::start_on_bench(Hertz sample_rate) const {
    return without_ripple ? without_ripple->start(sample_rate) : start(sample_rate);
}

std::unique_ptr<Learner> Contender::learner(Hertz sample_rate) const {
    return method->learner == nullptr ? nullptr : method->learner(settings, sample_rate);
}

std::optional<FrozenFilter> Contender::frozen(Hertz sample_rate, DegPerSec speed) const {
    if (method->frozen == nullptr) return std::nullopt;
    return method->frozen(settings, sample_rate, table.get(), speed);
}

std::optional<GearRatio> Contender::made_for() const {
    if (settings.has("gear-ratio")) return GearRatio(settings.number("gear-ratio"));
    if (table != nullptr) return table->spec().gear_ratio;
    return std::nullopt;
}

Contender make_contender(const Spec& spec, std::shared_ptr<const CandidateTable> table) {
    const Method& method = find_method(spec.name);
    return {spec.text(), &method, Settings(fmt::format("method {}", spec.name), spec, method.keys),
            std::move(table)};
}

}  // namespace ripplenotch
