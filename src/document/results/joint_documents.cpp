// SPDX-License-Identifier: MIT
#include "ripplenotch/document/joint_documents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "document/json/json.hpp"

namespace ripplenotch {

namespace {

constexpr std::array<std::string_view, 5> head_names = {"schema", "tool", "version", "command", "inputs"};

void add_inputs(Json& all, const Json& more) {
    for (const Json& input : more)
        if (std::find(all.begin(), all.end(), input) == all.end()) all.push_back(input);
}

}  // namespace

std::string joint_documents_text(std::string_view kind, std::span<const JointDocument> documents) {
    Json whole = Json::object(), inputs = Json::array(), joints = Json::array();
    for (const JointDocument& document : documents) {
        const Json one = Json::parse(document.text);
        Json& entry = joints.emplace_back(Json::object());
        entry["joint"] = document.joint;
        for (const auto& [name, value] : one.items()) {
            const bool in_head = std::find(head_names.begin(), head_names.end(), name) != head_names.end();
            if (name == "inputs")
                add_inputs(inputs, value);
            else if (in_head)
                whole[name] = value;
            else
                entry[name] = value;
        }
    }
    whole["schema"] = fmt::format("ripplenotch/{}/1", kind);
    whole["inputs"] = std::move(inputs);
    whole["joints"] = std::move(joints);
    return to_text(whole);
}

}  // namespace ripplenotch
