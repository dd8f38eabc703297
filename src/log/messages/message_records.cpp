// SPDX-License-Identifier: MIT
// The messages of one topic as records: a row a message.

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "log/containers/stored_array.hpp"
#include "log/messages/message_layout.hpp"
#include "log/messages/message_rows.hpp"
#include "log/messages/message_source.hpp"
#include "log/messages/topic_contents.hpp"
#include "log/records/joined_records.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr int asked = 1000;  // more than any names tell
constexpr std::uint64_t bytes_looked_at = std::uint64_t{1}
                                          << 23;  // bytes of messages, before the topic is chosen

class TopicChoice {
  public:
    TopicChoice(const OpenMessages& open, const ReadOptions& options)
        : open_(open), source_(open()), options_(options) {
        look();
        for (std::size_t c = 0; c < topics_.size(); ++c) lay_out(c);
    }
    Records records(const std::string& format) {
        const std::size_t chosen = choose();
        const MessageChannel channel = source_->channels()[chosen];
        // One kind of clock for all that is joined.
        bool header_clock = true;
        for (std::size_t c = 0; c < topics_.size(); ++c)
            if (c == chosen || is_asked(c)) header_clock = takes_header(c) && header_clock;
        RecordTable table;
        table.format = format;
        table.contents = topic_contents(*source_, topics_, [&](std::size_t number, const std::string& path) {
            return number == chosen || is_named(path);
        });
        table.options = fmt::format("--clock {}", header_clock ? "header" : "log");
        const MessageLayout& layout = topics_[chosen].layout;
        MessageLeaf clock{"log_time", "time", {}, true, true};
        for (const MessageLeaf& leaf : layout.leaves)
            if (leaf.clock && header_clock) clock.path = leaf.path;
        clock.type.kind = 'i';
        clock.type.big_endian = std::endian::native == std::endian::big;
        add_field(channel.topic, clock, table);
        for (const std::size_t leaf : leaves_beside_clock(layout, header_clock))
            add_field(channel.topic, layout.leaves[leaf], table);
        std::vector<SideSignal> sides = sides_of(chosen, header_clock);
        auto bytes = std::make_unique<MessageRecords>(std::move(source_), chosen, layout, header_clock);
        if (sides.empty()) return {std::move(bytes), std::move(table)};
        return {joined(std::move(bytes), std::move(sides), table), std::move(table)};
    }

  private:
    // Without a summary, a recording announces its channels on the way.
    std::unique_ptr<MessageSource> opened_up_to(std::size_t channel) const {
        auto source = open_();
        RecordedMessage message;
        while (source->channels().size() <= channel && source->next(message)) continue;
        return source;
    }
    // What --columns names of other topics.
    std::vector<SideSignal> sides_of(std::size_t chosen, bool header_clock) {
        std::vector<SideSignal> sides;
        for (std::size_t c = 0; c < topics_.size(); ++c) {
            if (c == chosen) continue;
            const Topic& topic = topics_[c];
            const auto beside = leaves_beside_clock(topic.layout, header_clock);
            for (std::size_t f = 0; f < beside.size(); ++f) {
                const MessageLeaf& leaf = topic.layout.leaves[beside[f]];
                const std::string path = fmt::format("{}.{}", source_->channels()[c].topic, leaf.path);
                if (!is_named(path)) continue;
                const double period_ns = static_cast<double>(topic.to_ns - topic.from_ns) /
                                         std::max(1.0, static_cast<double>(topic.seen) - 1.0);
                auto records =
                    std::make_unique<MessageRecords>(opened_up_to(c), c, topic.layout, header_clock);
                records->keep({0, f + 1});
                sides.push_back({path, leaf.read_as, std::move(records), leaf.type, join_limit_ns(period_ns),
                                 "", "message"});
            }
        }
        return sides;
    }
    std::unique_ptr<RecordSource> joined(std::unique_ptr<MessageRecords> base, std::vector<SideSignal> sides,
                                         RecordTable& table) const {
        const std::string how = options_.join.value_or("linear");
        std::vector<std::size_t> sizes;
        for (const NpyField& field : table.fields) sizes.push_back(field.size);
        add_sides(sides, how, table);
        return join_records(std::move(base), std::move(sizes), std::move(sides), join_named(how));
    }
    static void add_field(const std::string& topic, const MessageLeaf& leaf, RecordTable& table) {
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
        while ((bytes < bytes_looked_at || !saw_asked()) && source_->next(message)) {
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
    bool is_named(const std::string& path) const {
        return std::any_of(options_.columns.begin(), options_.columns.end(), [&](const std::string& entry) {
            const std::size_t equals = entry.find('=');
            return equals != std::string::npos && entry.substr(equals + 1) == path;
        });
    }
    bool is_asked(std::size_t channel, std::string_view role = "") const {
        return std::any_of(options_.columns.begin(), options_.columns.end(), [&](const std::string& entry) {
            const std::size_t equals = entry.find('=');
            return equals != std::string::npos && (role.empty() || entry.substr(0, equals) == role) &&
                   entry.substr(equals + 1).starts_with(source_->channels()[channel].topic + ".");
        });
    }
    void lay_out(std::size_t c) {
        const MessageChannel& channel = source_->channels()[c];
        Topic& topic = topics_[c];
        topic.refusal = refusal_of(channel);
        if (topic.refusal.empty() && topic.seen == 0) topic.refusal = "no message seen";
        if (!topic.refusal.empty()) return;
        try {
            topic.layout = lay_out_message(channel, topic.first);
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
                // The rows are those of the torque; what else is asked for is joined to them.
                if (best < asked || is_asked(c, "torque")) chosen = c;
                best = asked;
            }
            if (!topics_[c].refusal.empty() || best == asked) continue;
            std::vector<std::string> names;
            for (const MessageLeaf& leaf : topics_[c].layout.leaves) names.push_back(leaf.read_as);
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
            raise<DataError>("{}: read {}, expected a topic of numbers, as of sensor_msgs/msg/JointState",
                             source_->name(), seen.empty() ? "no message" : seen);
        }
        return *chosen;
    }
    bool takes_header(std::size_t chosen) const {
        const Topic& topic = topics_[chosen];
        const auto stamp = std::find_if(topic.layout.leaves.begin(), topic.layout.leaves.end(),
                                        [](const MessageLeaf& leaf) { return leaf.clock; });
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
        LeafOffsets offsets(topic.layout.leaves.size(), -1);
        offsets[static_cast<std::size_t>(stamp - topic.layout.leaves.begin())] = 0;
        topic.layout.program->reader(offsets)->read(topic.first, reinterpret_cast<char*>(&first));
        return first != 0;
    }

    const OpenMessages& open_;
    std::unique_ptr<MessageSource> source_;
    const ReadOptions& options_;
    std::vector<Topic> topics_;
};

}  // namespace

Records records_of_messages(const OpenMessages& open, const std::string& format, const ReadOptions& options) {
    return TopicChoice(open, options).records(format);
}

}  // namespace ripplenotch
