// SPDX-License-Identifier: MIT
#pragma once
// What every document has in common: schema, tool, version, inputs with their hashes, the settings that made
// it.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

struct InputRecord {
    std::string name;    ///< as given on the command line
    std::string sha256;  ///< of the bytes read; empty when not computed
    std::optional<std::size_t> rows;
};

/// The file with its hash, for the artifact that is made from it. Standard input has no hash: it is gone.
[[nodiscard]] InputRecord input_record(const std::string& path);

struct Provenance {
    std::vector<InputRecord> inputs;
    std::string command;  ///< the command line that reproduces it, without paths of its own making
    std::vector<Recording> recordings = {};  ///< the logs among the inputs
};

// The results of several joints of a log as one document.

/// What a command prints of one joint with --json.
struct JointDocument {
    std::string joint, text;
};

/// ripplenotch/KIND/1: the head that they share, with the inputs of all, and `joints`, each a document as it
/// is without its head, with the joint's name first.
[[nodiscard]] std::string joint_documents_text(std::string_view kind,
                                               std::span<const JointDocument> documents);

}  // namespace ripplenotch
