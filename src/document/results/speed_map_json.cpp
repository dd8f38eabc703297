// SPDX-License-Identifier: MIT
#include "ripplenotch/document/speed_map_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"

namespace ripplenotch {
std::string speed_map_text(const std::string& joint, const SpeedMap& map, std::string_view axis_name,
                           const std::optional<GearAccount>& gear, const Provenance& provenance) {
    Json json = document_head("spectrum", provenance);
    json["joint"] = joint;
    json["domain"] = map.axis_kind == Axis::time ? "campbell" : "order-map";
    json["gear"] = gear_to_json(gear);
    json["window"] = "hann";
    json["resolution"] = six_digits(map.resolution);
    json["speed_step_deg_s"] = map.speed_step_deg_s;
    json["runs_too_short"] = map.runs_too_short;
    json["axis"] = axis_name;
    json["axis_values"] = Json::array();
    for (const double value : map.axis) list_in(json, "axis_values").push_back(six_digits(value));
    json["rows"] = Json::array();
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        Json one = Json::object();
        one["speed_deg_s"] = six_digits(map.speed_deg_s[row]);
        one["windows"] = map.windows[row];
        one["amplitude_nm"] = Json::array();
        for (const double value : map.amplitude_nm[row])
            list_in(one, "amplitude_nm").push_back(six_digits(value));
        list_in(json, "rows").push_back(std::move(one));
    }
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
