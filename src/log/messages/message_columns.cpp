// SPDX-License-Identifier: MIT
// The messages of one topic as columns: a row a message.

#include "log/messages/message_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "log/columns/decide_layout.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

// Why messages of a channel cannot be read; empty where they can, as far as the channel tells.
std::string refusal_of(const MessageChannel& channel) {
    if (channel.encoding == "json") return {};
    if (channel.encoding != "cdr") return fmt::format("{} messages, which are not read", channel.encoding);
    if (!channel.schema.empty() && channel.schema_encoding != "ros2msg")
        return fmt::format("defined in {}, which is not read", channel.schema_encoding);
    if (channel.schema.empty() && known_ros_schema(channel.type).empty())
        return "not defined in the recording";
    return {};
}

MessageLayout lay_out_message(const MessageChannel& channel, std::string_view first) {
    if (channel.encoding == "json") return lay_out_json(first);
    const std::string_view schema =
        channel.schema.empty() ? known_ros_schema(channel.type) : std::string_view(channel.schema);
    return lay_out_cdr(schema, channel.type, first);
}

/// The leaves that are columns, the clock first: a leaf, or the time of recording, which stands behind them
/// all.
std::vector<std::size_t> leaves_of(const MessageLayout& layout, bool header_clock) {
    std::vector<std::size_t> leaves = {layout.leaves.size()};
    for (std::size_t l = 0; l < layout.leaves.size(); ++l) {
        if (layout.leaves[l].clock && header_clock)
            leaves.front() = l;
        else
            leaves.push_back(l);
    }
    return leaves;
}

/// Column 0 is the clock, in nanoseconds.
class MessageColumns final : public Columns {
  public:
    /// `header_clock`: the layout has a leaf that is the clock, and it is taken; else the time of recording.
    MessageColumns(std::unique_ptr<MessageSource> source, std::size_t channel, MessageLayout layout,
                   bool header_clock)
        : Columns(source->name(), info_of(source->channels()[channel].topic, layout, header_clock)),
          source_(std::move(source)),
          topic_(source_->channels()[channel].topic),
          layout_(std::move(layout)),
          leaf_of_(leaves_of(layout_, header_clock)),
          row_(layout_.leaves.size() + 1) {
        source_->restart(channel);
    }
    std::size_t next(std::size_t rows, NumberRows& into, std::string& /*bytes*/) override {
        std::vector<bool> leaves(row_.size(), false);
        for (std::size_t c = 0; c < leaf_of_.size(); ++c) leaves[leaf_of_[c]] = wanted(c);
        leaves.pop_back();
        RecordedMessage message;
        std::size_t count = 0;
        while (!ended_ && count < rows) {
            ended_ = !source_->next(message);
            if (ended_) break;
            try {
                layout_.read(message.bytes, leaves, row_);
            } catch (const DataError& error) {
                raise<DataError>("{}: message {}, {}: read {}", name(), message.number, topic_, error.what());
            }
            row_.back() = {static_cast<double>(message.log_time_ns), message.log_time_ns};
            for (std::size_t c = 0; c < leaf_of_.size(); ++c) {
                if (!wanted(c)) continue;
                into[c].values.push_back(row_[leaf_of_[c]].value);
                if (info()[c].whole) into[c].counts.push_back(row_[leaf_of_[c]].count);
            }
            ++count;
        }
        return count;
    }

  private:
    static std::vector<ColumnInfo> info_of(const std::string& topic, const MessageLayout& layout,
                                           bool header_clock) {
        std::vector<ColumnInfo> info;
        for (const std::size_t l : leaves_of(layout, header_clock)) {
            const bool clock = info.empty();
            const MessageLeaf log_time{"log_time", "time", {}, true, true};
            const MessageLeaf& leaf = l < layout.leaves.size() ? layout.leaves[l] : log_time;
            // The stamp of something else is no clock of the messages.
            info.push_back({fmt::format("{}.{}", topic, leaf.path),
                            leaf.stamp && !clock ? "other" : leaf.read_as, clock ? "ns" : "",
                            clock || leaf.type.whole(), true});
        }
        return info;
    }

    std::unique_ptr<MessageSource> source_;
    std::string topic_;
    MessageLayout layout_;
    std::vector<std::size_t> leaf_of_;  ///< by column; the last number of a row is the time of recording
    std::vector<LeafNumber> row_;
    bool ended_ = false;  ///< behind it some sources would begin again
};

// The topics of a recording, as `info` lists them.

/// What the first messages tell of a topic.
struct Topic {
    std::string first;  ///< its first message; empty where none was seen
    std::uint64_t seen = 0;
    std::int64_t from_ns = 0, to_ns = 0;
    MessageLayout layout;
    std::string refusal;  ///< why it has no numbers; empty where it has
};

std::optional<double> rate_of(const Topic& topic) {
    if (topic.seen < 2 || topic.to_ns <= topic.from_ns) return std::nullopt;
    // A damaged recording may hold any two times: their distance fits an unsigned number only.
    const auto ns = static_cast<std::uint64_t>(topic.to_ns) - static_cast<std::uint64_t>(topic.from_ns);
    return 1e9 * static_cast<double>(topic.seen - 1) / static_cast<double>(ns);
}

// Elements of an array are one thing, position[0..6]: the last of those that begin with this one.
std::size_t last_element(const std::vector<MessageLeaf>& leaves, std::size_t first) {
    const std::string& path = leaves[first].path;
    if (!path.ends_with("[0]")) return first;
    const std::string stem = path.substr(0, path.size() - 2);
    std::size_t last = first;
    while (last + 1 < leaves.size() && leaves[last + 1].path == fmt::format("{}{}]", stem, last + 1 - first))
        ++last;
    return last;
}

// A line a number that messages have, or a list of numbers; a line for a topic that is not read, with why. A
// path stands for a column where `is_read` says so.
std::vector<ContentEntry> topic_contents(
    const MessageSource& source, const std::vector<Topic>& topics,
    const std::function<bool(std::size_t channel, const std::string& path)>& is_read) {
    std::vector<ContentEntry> entries;
    for (std::size_t c = 0; c < topics.size(); ++c) {
        const Topic& topic = topics[c];
        const MessageChannel& channel = source.channels()[c];
        const auto count = source.count_of(c);
        ContentEntry entry;
        entry.path = channel.topic;
        entry.shape =
            count ? fmt::format("{} messages", *count) : fmt::format("{} messages and more", topic.seen);
        entry.type = fmt::format("{}, {}", channel.type, topic.refusal);
        entry.rate_hz = rate_of(topic);
        if (!topic.refusal.empty()) {
            entries.push_back(entry);
            continue;
        }
        const auto& leaves = topic.layout.leaves;
        for (std::size_t l = 0, last = 0; l < leaves.size(); l = last + 1) {
            last = last_element(leaves, l);
            const std::string first = fmt::format("{}.{}", channel.topic, leaves[l].path);
            entry.path =
                last > l ? fmt::format("{}0..{}]", first.substr(0, first.size() - 2), last - l) : first;
            entry.type = leaves[l].stamp ? "stamp" : type_name(leaves[l].type);
            entry.unit = leaves[l].stamp ? "ns" : "";
            entry.read = false;
            for (std::size_t e = l; e <= last; ++e)
                entry.read = entry.read || is_read(c, fmt::format("{}.{}", channel.topic, leaves[e].path));
            entries.push_back(entry);
        }
    }
    return entries;
}

constexpr int tells_by_option = 1000;  // more than any names tell
constexpr std::uint64_t bytes_looked_at = std::uint64_t{1}
                                          << 23;  // bytes of messages, before the topic is chosen

class TopicChoice {
  public:
    TopicChoice(const OpenMessages& open, const ReadOptions& options)
        : open_(open), source_(open()), options_(options) {
        look();
        for (std::size_t c = 0; c < topics_.size(); ++c) lay_out(c);
    }
    ColumnLog log(const std::string& format) {
        const std::size_t chosen = choose();
        // One kind of clock for all that is joined.
        bool header_clock = true;
        for (std::size_t c = 0; c < topics_.size(); ++c)
            if (c == chosen || is_asked(c)) header_clock = takes_header(c) && header_clock;
        ColumnLog log;
        log.format = format;
        log.contents = topic_contents(*source_, topics_, [&](std::size_t number, const std::string& path) {
            return number == chosen || is_named(path);
        });
        log.options = fmt::format("--clock {}", header_clock ? "header" : "log");
        std::vector<SideColumn> sides = sides_of(chosen, header_clock);
        log.columns = std::make_unique<MessageColumns>(std::move(source_), chosen, topics_[chosen].layout,
                                                       header_clock);
        if (!sides.empty()) join_columns(log, 1.0, std::move(sides), options_);
        return log;
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
    std::vector<SideColumn> sides_of(std::size_t chosen, bool header_clock) {
        std::vector<SideColumn> sides;
        for (std::size_t c = 0; c < topics_.size(); ++c) {
            if (c == chosen) continue;
            const MessageLayout& layout = topics_[c].layout;
            const std::vector<std::size_t> leaves = leaves_of(layout, header_clock);
            for (std::size_t f = 1; f < leaves.size(); ++f) {
                const std::string& path = layout.leaves[leaves[f]].path;
                if (is_named(fmt::format("{}.{}", source_->channels()[c].topic, path)))
                    sides.push_back(
                        {std::make_unique<MessageColumns>(opened_up_to(c), c, layout, header_clock), f, 1.0,
                         "message"});
            }
        }
        return sides;
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
    bool is_named(const std::string& path) const { return !asked_role(options_, path).empty(); }
    bool is_asked(std::size_t channel, std::string_view role = "") const {
        return std::ranges::any_of(options_.columns, [&](const std::string& entry) {
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
                if (best < tells_by_option || is_asked(c, "torque")) chosen = c;
                best = tells_by_option;
            }
            if (!topics_[c].refusal.empty() || best == tells_by_option) continue;
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
        const auto stamp =
            std::ranges::find_if(topic.layout.leaves, [](const MessageLeaf& leaf) { return leaf.clock; });
        const bool has = stamp != topic.layout.leaves.end();
        if (options_.clock == "log") return false;
        if (options_.clock == "header") {
            if (!has)
                raise<UsageError>("--clock header: messages of {} in {} have no header; use --clock log",
                                  source_->channels()[chosen].topic, source_->name());
            return true;
        }
        if (!has) return false;
        std::vector<bool> wanted(topic.layout.leaves.size(), false);
        std::vector<LeafNumber> first(wanted.size());
        const auto clock = static_cast<std::size_t>(stamp - topic.layout.leaves.begin());
        wanted[clock] = true;
        topic.layout.read(topic.first, wanted, first);
        return first[clock].count != 0;  // who does not stamp leaves it at 0
    }

    const OpenMessages& open_;
    std::unique_ptr<MessageSource> source_;
    const ReadOptions& options_;
    std::vector<Topic> topics_;
};

}  // namespace

void refuse_length(std::size_t count, const std::string& path, std::size_t expected) {
    raise<DataError>(
        "{} elements of {}, expected {} as in the first message; record messages of one shape on a topic",
        count, path, expected);
}

void refuse_name(std::string_view name, const std::string& path, const std::string& expected) {
    raise<DataError>(
        "'{}' as {}, expected '{}' as in the first message; record the joints on topics of their own",
        name.substr(0, 60), path, expected);
}

ColumnLog columns_of_messages(const OpenMessages& open, const std::string& format,
                              const ReadOptions& options) {
    return TopicChoice(open, options).log(format);
}

}  // namespace ripplenotch
