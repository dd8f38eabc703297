// SPDX-License-Identifier: MIT
#include "cli/diagnose/decided_text.hpp"

#include <fmt/format.h>

#include "cli/talk.hpp"

namespace ripplenotch {

std::string short_number(double value) {
    const std::string text = fmt::format("{:.4g}", value);
    return text == "-0" ? "0" : text;
}

std::string value_text(const Term& term, const FittedValue& value) {
    const Parameter& parameter = term.effect->parameters[value.parameter];
    std::string text = fmt::format("{} = {}", parameter.name, short_number(value.value));
    if (value.at_bound) text += " (at its bound)";
    // An interval over all that the parameter may be says nothing, in whatever digits.
    if (value.ci95 && value.ci95->low <= parameter.lower && value.ci95->high >= parameter.upper) {
        text += " (not identifiable from this log)";
    } else if (value.ci95) {
        text += fmt::format(" [{}, {}]", short_number(value.ci95->low), short_number(value.ci95->high));
    }
    return text;
}

std::string accepted_text(const Diagnosis& diagnosis) {
    std::string text;
    for (const AcceptedFinding& one : diagnosis.accepted) {
        std::string values;
        for (std::size_t p = 0; p < one.term.values.size(); ++p) {
            const Parameter& parameter = one.term.effect->parameters[p];
            if (parameter.left_out == LeftOut::refused)
                values += fmt::format(", {} = {}", parameter.name, short_number(*one.term.values[p]));
        }
        for (const FittedValue& value : one.values) values += ", " + value_text(one.term, value);
        text += fmt::format("accepted by you and not confirmed by this log ({}): {}{}\n",
                            status_name(one.status), one.term.effect->name, values);
    }
    return text;
}

std::string band_table(const std::vector<BandGap>& bands) {
    if (bands.empty()) return {};
    std::vector<std::vector<std::string>> rows = {
        {"frequency", "torque, Nm rms", "beside what is given", "and the model"}};
    for (const BandGap& band : bands) {
        const std::string name = band.from_hz == 0.0 ? fmt::format("below {:g} Hz", band.to_hz)
                                 : band.to_hz == 0.0
                                     ? fmt::format("above {:g} Hz", band.from_hz)
                                     : fmt::format("{:g} to {:g} Hz", band.from_hz, band.to_hz);
        rows.push_back({name, short_number(band.torque_nm), short_number(band.beside_given_nm),
                        short_number(band.after_nm)});
    }
    return text_table(rows, "lr");
}

std::string next_text(const std::vector<std::string>& steps) {
    std::string text;
    for (const std::string& step : steps) text += fmt::format("next: {}\n", step);
    return text;
}

}  // namespace ripplenotch
