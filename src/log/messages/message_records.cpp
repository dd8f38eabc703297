// SPDX-License-Identifier: MIT
// The messages of one topic as records: a row a message.

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "log/containers/stored_array.hpp"
#include "log/messages/cdr_program.hpp"
#include "log/messages/message_rows.hpp"
#include "log/messages/message_source.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::uint64_t looked_at = std::uint64_t{1} << 23;  // bytes of messages, before the topic is chosen

/// What the first messages tell of a topic.
struct Topic {
    std::string first;  ///< its first message; empty where none was seen
    std::uint64_t seen = 0;
    std::int64_t from_ns = 0, to_ns = 0;
    CdrLayout layout;
    std::string refusal;  ///< why it has no numbers; empty where it has
};

class TopicChoice {
  public:
    TopicChoice(std::unique_ptr<MessageSource> source, const ReadOptions& options)
        : source_(std::move(source)), options_(options) {
        look();
        for (std::size_t c = 0; c < topics_.size(); ++c) lay_out(c);
    }
    Records records(const std::string& format) {
        const std::size_t chosen = choose();
        const MessageChannel channel = source_->channels()[chosen];
        const bool header_clock = takes_header(chosen);
        RecordTable table;
        table.format = format;
        table.contents = contents(chosen);
        table.options = fmt::format("--clock {}", header_clock ? "header" : "log");
        CdrLeaf clock{header_clock ? "header.stamp" : "log_time", "time", {}, true, true};
        clock.type.kind = 'i';
        clock.type.big_endian = std::endian::native == std::endian::big;
        add_field(channel.topic, clock, table);
        CdrLayout& layout = topics_[chosen].layout;
        for (const std::size_t leaf : leaves_beside_clock(layout, header_clock))
            add_field(channel.topic, layout.leaves[leaf], table);
        auto bytes =
            std::make_unique<MessageRecords>(std::move(source_), chosen, std::move(layout), header_clock);
        return {std::move(bytes), std::move(table)};
    }

  private:
    static void add_field(const std::string& topic, const CdrLeaf& leaf, RecordTable& table) {
        NpyField field = leaf.type;
        field.name = fmt::format("{}.{}", topic, leaf.path);
        field.offset = table.record_size;
        table.record_size += field.size;
        table.fields.push_back(field);
        const bool clock = table.fields.size() == 1;
        // The stamp of something else is no clock of the messages.
        table.read_as.push_back(leaf.stamp && !clock ? "other" : leaf.read_as);
        table.units.emplace_back(clock ? "ns" : "");
    }
    // Until a part of the recording has been seen, and a message of each topic that was asked for.
    void look() {
        RecordedMessage message;
        std::uint64_t bytes = 0;
        while ((bytes < looked_at || !saw_asked()) && source_->next(message)) {
            topics_.resize(source_->channels().size());
            Topic& topic = topics_[message.channel];
            bytes += message.bytes.size();
            if (topic.seen++ == 0) {
                topic.first = message.bytes;
                topic.from_ns = message.log_time_ns;
            }
            topic.to_ns = message.log_time_ns;
        }
        topics_.resize(source_->channels().size());
    }
    bool saw_asked() const {
        for (std::size_t c = 0; c < source_->channels().size(); ++c)
            if (is_asked(c) && (c >= topics_.size() || topics_[c].seen == 0)) return false;
        return true;
    }
    bool is_asked(std::size_t channel) const {
        return std::any_of(options_.columns.begin(), options_.columns.end(), [&](const std::string& entry) {
            const std::size_t equals = entry.find('=');
            return equals != std::string::npos &&
                   entry.substr(equals + 1).starts_with(source_->channels()[channel].topic + ".");
        });
    }
    void lay_out(std::size_t c) {
        const MessageChannel& channel = source_->channels()[c];
        Topic& topic = topics_[c];
        std::string_view schema = channel.schema;
        const bool none = schema.empty();
        if (none) schema = known_ros_schema(channel.type);
        if (channel.encoding != "cdr")
            topic.refusal = fmt::format("{} messages, which are not read", channel.encoding);
        else if (!none && channel.schema_encoding != "ros2msg")
            topic.refusal = fmt::format("defined in {}, which is not read", channel.schema_encoding);
        else if (schema.empty())
            topic.refusal = "not defined in the recording";
        else if (topic.seen == 0)
            topic.refusal = "no message seen";
        if (!topic.refusal.empty()) return;
        try {
            topic.layout = lay_out_cdr(parse_ros_schema(schema, channel.type), topic.first);
            if (topic.layout.leaves.empty()) topic.refusal = "no numbers";
        } catch (const DataError& error) {
            topic.refusal = fmt::format("not read: {}", error.what());
        }
    }
    std::size_t choose() const {
        std::optional<std::size_t> chosen;
        int best = -1;
        for (std::size_t c = 0; c < topics_.size(); ++c) {
            if (is_asked(c)) {
                if (!topics_[c].refusal.empty())
                    raise<UsageError>("--columns: {}: {} is {}", source_->name(),
                                      source_->channels()[c].topic, topics_[c].refusal);
                if (best == 1000)
                    raise<UsageError>(
                        "--columns: names two topics of {}, {} and {}, whose clocks differ; name columns of "
                        "one",
                        source_->name(), source_->channels()[*chosen].topic, source_->channels()[c].topic);
                best = 1000;
                chosen = c;
            }
            if (!topics_[c].refusal.empty() || best == 1000) continue;
            std::vector<std::string> names;
            for (const CdrLeaf& leaf : topics_[c].layout.leaves) names.push_back(leaf.read_as);
            if (const int tells = names_tell(names); tells > best) {
                best = tells;
                chosen = c;
            }
        }
        if (!chosen) {
            std::string seen;
            for (std::size_t c = 0; c < std::min<std::size_t>(topics_.size(), 5); ++c)
                seen += fmt::format("{}{} ({}: {})", c == 0 ? "" : ", ", source_->channels()[c].topic,
                                    source_->channels()[c].type, topics_[c].refusal);
            raise<DataError>(
                "{}: read {}, expected a topic of numbers in CDR, as of sensor_msgs/msg/JointState",
                source_->name(), seen.empty() ? "no message" : seen);
        }
        return *chosen;
    }
    bool takes_header(std::size_t chosen) const {
        const Topic& topic = topics_[chosen];
        const auto stamp = std::find_if(topic.layout.leaves.begin(), topic.layout.leaves.end(),
                                        [](const CdrLeaf& leaf) { return leaf.clock; });
        const bool has = stamp != topic.layout.leaves.end();
        if (options_.clock == "log") return false;
        if (options_.clock == "header") {
            if (!has)
                raise<UsageError>("--clock header: messages of {} in {} have no header; say --clock log",
                                  source_->channels()[chosen].topic, source_->name());
            return true;
        }
        if (!has) return false;
        std::int64_t first = 0;  // who does not stamp leaves it at 0
        std::vector<std::ptrdiff_t> offsets(topic.layout.leaves.size(), -1);
        offsets[static_cast<std::size_t>(stamp - topic.layout.leaves.begin())] = 0;
        run_cdr(topic.layout.steps, topic.first, offsets, reinterpret_cast<char*>(&first));
        return first != 0;
    }
    // Elements of an array are one thing: position[0..6].
    std::vector<ContentEntry> contents(std::size_t chosen) const {
        std::vector<ContentEntry> entries;
        for (std::size_t c = 0; c < topics_.size(); ++c) {
            const Topic& topic = topics_[c];
            const MessageChannel& channel = source_->channels()[c];
            const auto count = source_->count_of(c);
            const std::string shape =
                count ? fmt::format("{} messages", *count) : fmt::format("{} messages and more", topic.seen);
            std::optional<double> rate;
            if (topic.seen > 1 && topic.to_ns > topic.from_ns)
                rate = 1e9 * static_cast<double>(topic.seen - 1) /
                       static_cast<double>(topic.to_ns - topic.from_ns);
            if (!topic.refusal.empty()) {
                entries.push_back({channel.topic, shape, fmt::format("{}, {}", channel.type, topic.refusal),
                                   "", rate, false});
                continue;
            }
            const auto& leaves = topic.layout.leaves;
            for (std::size_t l = 0; l < leaves.size(); ++l) {
                const std::string& path = leaves[l].path;
                std::string shown = path;
                if (path.ends_with("[0]")) {
                    const std::string stem = path.substr(0, path.size() - 2);
                    std::size_t last = l;
                    while (last + 1 < leaves.size() &&
                           leaves[last + 1].path == fmt::format("{}{}]", stem, last + 1 - l))
                        ++last;
                    if (last > l) shown = fmt::format("{}0..{}]", stem, last - l);
                    entries.push_back({fmt::format("{}.{}", channel.topic, shown), shape,
                                       type_name(leaves[l].type), "", rate, c == chosen});
                    l = last;
                    continue;
                }
                entries.push_back({fmt::format("{}.{}", channel.topic, shown), shape,
                                   leaves[l].stamp ? "stamp" : type_name(leaves[l].type),
                                   leaves[l].stamp ? "ns" : "", rate, c == chosen});
            }
        }
        return entries;
    }

    std::unique_ptr<MessageSource> source_;
    const ReadOptions& options_;
    std::vector<Topic> topics_;
};

}  // namespace

Records records_of_messages(std::unique_ptr<MessageSource> source, const std::string& format,
                            const ReadOptions& options) {
    return TopicChoice(std::move(source), options).records(format);
}

}  // namespace ripplenotch
