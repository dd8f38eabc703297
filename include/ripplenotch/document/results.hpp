// SPDX-License-Identifier: MIT
#pragma once
// Results as documents: written as JSON, and read back where a command computes with them. The same result
// gives the same bytes. What reads throws DataError that names `source`, the field, what it holds and what
// was expected; load_... reads a file, or standard input when the path is "-".

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

struct ArmAccount;
struct Diagnosis;
struct FeatureLine;
struct Figure;
struct FrictionDiagnosis;
struct GearAccount;
struct Identification;
struct LogInfo;
struct MapFit;
struct MjcfAccount;
struct Trend;

// joint.json: what identify found, the input of design.

[[nodiscard]] std::string identification_text(const Identification& identification,
                                              const Provenance& provenance);

/// Several joints of one file in one object, schema ripplenotch/joints/1: {"joints": [...]}, each entry with
/// the fields of joint.json.
[[nodiscard]] std::string identifications_text(std::span<const Identification> identifications,
                                               const Provenance& provenance);

[[nodiscard]] Identification identification_from_json(std::string_view text, const std::string& source);
[[nodiscard]] Identification load_identification(const std::string& path);

// map.json: a ripple map as filter, export and report read it.

/// Schema ripplenotch/map/1.
[[nodiscard]] std::string map_text(const MapFit& fit, const Provenance& provenance);
[[nodiscard]] MapFit map_from_json(std::string_view text, const std::string& source);
[[nodiscard]] MapFit load_map(const std::string& path);

/// Whether the file of this name is a document of this kind ("map", "model"), by its first lines. False for
/// what is no regular file: it could not be read again.
[[nodiscard]] bool is_document(const std::string& path, std::string_view kind);

// What info says about a log.

/// The object of info --json, whose fields docs/commands/info.md names: of one log at the top, of several in
/// {"logs": [...]}, each with the same fields. Of several joints, `held_samples` is the largest,
/// `clock_factor` that of the joint that moves most, `speed_deg_s` spans all; each joint's own figures are in
/// `joints`.
[[nodiscard]] std::string info_to_json(std::span<const LogInfo> logs, const Provenance& provenance);

// diagnosis.json: what a diagnosis found, docs/formats/diagnosis.md.

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

// Lines of features, one object a line, and what trend found in them.

/// One line with its line feed, schema ripplenotch/features/1; same features, same bytes. Units stand in the
/// names, intervals under "..._ci95_...", reasons for null in "not_told".
[[nodiscard]] std::string feature_line_text(const FeatureLine& line);

/// Reads one line back. Throws DataError that names `source`, the field, what it holds and what was expected.
[[nodiscard]] FeatureLine feature_line_from_json(std::string_view text, const std::string& source);

/// All lines of a text; empty ones do not count. Throws DataError with source and line.
[[nodiscard]] std::vector<FeatureLine> feature_lines_from_text(std::string_view text,
                                                               const std::string& source);

// trend.json: what changed in a fleet, as tables that a page shows and others read.

/// One sentence: how many joints changed, what changed most, and how many false alarms are to be expected.
[[nodiscard]] std::string trend_verdict(const Trend& trend);

/// The whole text of trend.json, schema ripplenotch/trend/1; same trend, same bytes.
[[nodiscard]] std::string trend_text(const Trend& trend, const Provenance& provenance);

// What a figure shows: the data behind a picture, for any other program that draws.

/// Schema ripplenotch/figure/1; numbers with eight significant digits, null where a line breaks or a cell is
/// empty. Same figure, same bytes.
[[nodiscard]] std::string figure_text(const Figure& figure, const Provenance& provenance);

/// Reads it back. Throws DataError that names `source`, the field, and what was expected.
[[nodiscard]] Figure figure_from_json(std::string_view text, const std::string& source);

}  // namespace ripplenotch
