// SPDX-License-Identifier: MIT
#pragma once
// The results of several joints of a log as one document.

#include <span>
#include <string>
#include <string_view>

namespace ripplenotch {

/// What a command prints of one joint with --json.
struct JointDocument {
    std::string joint, text;
};

/// ripplenotch/KIND/1: the head that they share, with the inputs of all, and `joints`, each a document as it
/// is without its head, with the joint's name first.
[[nodiscard]] std::string joint_documents_text(std::string_view kind,
                                               std::span<const JointDocument> documents);

}  // namespace ripplenotch
