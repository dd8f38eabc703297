// SPDX-License-Identifier: MIT
#pragma once
// diagnosis.json: what a diagnosis found, docs/formats/diagnosis.md.

#include <span>
#include <string>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/friction_table.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"

namespace ripplenotch {

/// What a document says of one joint of a log.
struct DiagnosedJoint {
    std::string joint;
    const Diagnosis& diagnosis;
    const GearAccount& gear;            ///< of the model as given
    const ArmAccount* arm = nullptr;    ///< what an arm was given, if one
    const MjcfAccount* mjcf = nullptr;  ///< the improved model as it was written for MuJoCo
};

/// Schema ripplenotch/diagnosis/1.
[[nodiscard]] std::string write_diagnosis(const DiagnosedJoint& joint, const Provenance& provenance);

/// Schema ripplenotch/diagnoses/1: a list of what write_diagnosis tells of each, with its joint's name.
[[nodiscard]] std::string write_diagnoses(std::span<const DiagnosedJoint> joints,
                                          const Provenance& provenance);

/// Schema ripplenotch/friction-table/1.
[[nodiscard]] std::string write_friction(const FrictionDiagnosis& found, const Provenance& provenance);

}  // namespace ripplenotch
