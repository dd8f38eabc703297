// SPDX-License-Identifier: MIT
#include "ripplenotch/document/simulation_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/fields/model_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

std::string write_simulation(const Simulation& simulation, const Provenance& provenance) {
    Json json = document_head("simulation", provenance);
    json["rows"] = simulation.rows;
    json["sample_rate_hz"] = simulation.sample_rate.value();
    json["duration_s"] = static_cast<double>(simulation.rows) / simulation.sample_rate.value();
    json["columns"] = simulation.columns;
    json["motions"] = simulation.motions;
    json["seed"] = simulation.seed;
    if (const auto& followed = simulation.followed) {
        json["along_log"] = {{"smoothing_s", followed->smoothing.value()},
                             {"measured_rms_nm", followed->measured_rms_nm},
                             {"residual_rms_nm", to_digits(followed->residual_rms_nm)}};
    }
    json["noise_rms_nm"] = simulation.noise_rms.value();
    json["noise_correlation"] = simulation.noise_correlation;
    json["velocity_noise_rms_deg_s"] = simulation.velocity_noise_rms.value();
    json["torque_nm"] = {{"min", simulation.torque_min_nm}, {"max", simulation.torque_max_nm}};
    json["speed_deg_s"] = {{"min", simulation.speed_min_deg_s}, {"max", simulation.speed_max_deg_s}};
    json["gear"] = gear_to_json(simulation.gear);
    json["model"] = Json::object();
    put_model(json["model"], simulation.model);
    json["output"] = {{"name", simulation.output}, {"sha256", simulation.output_sha256}};
    return to_text(json);
}

}  // namespace ripplenotch
