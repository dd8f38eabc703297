// SPDX-License-Identifier: MIT
#include "document/json/json.hpp"

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

bool is_time(std::string_view name) { return name.ends_with("_s") && !name.ends_with("deg_s"); }

void round_fitted(Json& json) {
    if (json.is_number_float()) {
        json = to_digits(json.get<double>());
    } else if (json.is_object()) {
        for (auto& [name, value] : json.items()) {
            if (!is_time(name)) round_fitted(value);
        }
    } else if (json.is_array()) {
        for (Json& value : json) round_fitted(value);
    }
}

}  // namespace

Json six_digits(double value) { return finite_or_null(to_digits(value, 6) + 0.0); }

std::string to_fitted_text(Json json) {
    round_fitted(json);
    return to_text(json);
}

std::string to_text(const Json& json) {
    // Names of files and columns may hold bytes that are not UTF-8; they are replaced rather than refused.
    return visible_json(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace ripplenotch
