// SPDX-License-Identifier: MIT
#include "ripplenotch/document/shard_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/fields/fields.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::string shard_record_text(const ShardRecord& record) {
    Json json;
    json["schema"] = "ripplenotch/shard/1";
    json["version"] = record.version;
    json["settings"] = record.settings;
    json["manifest_sha256"] = record.manifest_sha256;
    json["shard"] = record.shard.number;
    json["shards"] = record.shard.of;
    json["logs"] = record.logs;
    json["lines"] = record.lines;
    json["failed"] = record.failed;
    json["sha256"] = record.sha256;
    return to_text(json);
}

ShardRecord shard_record_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "shard");
    Fields fields(json, source, "");
    fields.ignore({"schema"});
    ShardRecord record;
    record.version = fields.text("version");
    record.settings = fields.text("settings");
    record.manifest_sha256 = fields.text("manifest_sha256");
    record.shard = {fields.whole("shard"), fields.whole("shards")};
    if (record.shard.number < 1 || record.shard.number > record.shard.of || record.shard.of > most_shards)
        raise<DataError>("{} is {}, expected 1 to {}", fields.where("shard"), record.shard.number,
                         record.shard.of);
    record.logs = fields.whole("logs");
    record.lines = fields.whole("lines");
    record.failed = fields.whole("failed");
    record.sha256 = fields.text("sha256");
    fields.finish();
    return record;
}

}  // namespace ripplenotch
