#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "host/lab/depth_study/depth_study.hpp"

namespace octoskin::depth_study {
namespace {

using evaluation::SeenMetrics;
using evaluation::SeenShares;

constexpr std::string_view kUndefined = "-";

/// A row of a table: the figures of its seeds, and what the row begins with.
template <class Figures>
struct Row {
    std::string title;
    std::vector<const Figures*> seeds;
};

/// The figures of one noise, in rows of equal titles, in the order of their first figures.
template <class Figures, class Title>
std::vector<Row<Figures>> rows_of(const std::vector<Figures>& all, const std::string& noise,
                                  const Title& title) {
    std::vector<Row<Figures>> rows;
    for (const Figures& figures : all) {
        if (figures.subject.noise != noise) continue;
        const std::string text = title(figures);
        auto row = std::ranges::find(rows, text, &Row<Figures>::title);
        if (row == rows.end()) row = rows.insert(rows.end(), {text, {}});
        row->seeds.push_back(&figures);
    }
    return rows;
}

/// In the order of their first figures.
template <class Figures>
std::vector<std::string> noises_of(const std::vector<Figures>& all) {
    std::vector<std::string> noises;
    for (const Figures& figures : all)
        if (std::ranges::find(noises, figures.subject.noise) == noises.end())
            noises.push_back(figures.subject.noise);
    return noises;
}

std::string number(const std::optional<double>& value, int digits = 3) {
    return value ? fmt::format("{:.{}f}", *value, digits) : std::string(kUndefined);
}

struct Spread {
    std::optional<double> mean = std::nullopt, least = std::nullopt, most = std::nullopt;
    bool is_complete = true;  ///< every seed has a value
};

/// Undefined values are left out.
template <class Figures, class Value>
Spread spread_of(const Row<Figures>& row, const Value& value) {
    Spread spread;
    double sum = 0.0;
    std::size_t count = 0;
    for (const Figures* figures : row.seeds) {
        const std::optional<double> one = value(*figures);
        spread.is_complete = spread.is_complete && one.has_value();
        if (!one) continue;
        sum += *one;
        count += 1;
        spread.least = std::min(spread.least.value_or(*one), *one);
        spread.most = std::max(spread.most.value_or(*one), *one);
    }
    if (count > 0) spread.mean = sum / static_cast<double>(count);
    return spread;
}

using SeenRow = Row<SeenFigures>;

std::string seen_title(const SeenFigures& of) {
    return fmt::format("{:<14}{:<16}{:>6.1f}", of.subject.scenario, of.subject.label, of.t_s);
}

Spread spread_of(const SeenRow& row, std::optional<double> SeenMetrics::*member) {
    return spread_of(row, [=](const SeenFigures& of) { return of.seen.*member; });
}

void add_seen_row(std::string& text, const SeenRow& row) {
    auto out = std::back_inserter(text);
    const Spread precision = spread_of(row, &SeenMetrics::precision);
    const Spread free = spread_of(row, &SeenMetrics::seen_free);
    fmt::format_to(out, "{} {:>14}", row.title,
                   fmt::format("{} ({})", number(precision.mean), number(precision.least)));
    for (const auto member :
         {&SeenMetrics::precision_tolerant, &SeenMetrics::f1_seen, &SeenMetrics::seen_occupied})
        fmt::format_to(out, "{:>10}", number(spread_of(row, member).mean));
    fmt::format_to(out, " {:>14}", fmt::format("{} ({})", number(free.mean), number(free.most)));
    for (const auto member : {&SeenMetrics::seen_unknown, &SeenMetrics::body_2cm, &SeenMetrics::body_5cm,
                              &SeenMetrics::availability_5cm})
        fmt::format_to(out, "{:>10}", number(spread_of(row, member).mean, 4));
    fmt::format_to(out, "\n");
}

/// The seeds' voxels of one class, or of those that the pixels are too coarse for.
SeenShares pooled(const SeenRow& row, std::optional<std::size_t> of_class) {
    SeenShares sum;
    for (const SeenFigures* figures : row.seeds)
        sum.add(of_class ? figures->seen.by_class[*of_class] : figures->seen.too_coarse);
    return sum;
}

void add_class_row(std::string& text, const SeenRow& row) {
    auto out = std::back_inserter(text);
    const auto add = [&](const SeenShares& shares) {
        fmt::format_to(out, "{:>16}",
                       shares.voxels == 0 ? std::string(kUndefined)
                                          : fmt::format("{} / {}", number(shares.occupied_share()),
                                                        number(shares.free_share())));
    };
    fmt::format_to(out, "{}", row.title);
    for (std::size_t i = 0; i < evaluation::kThicknessClasses; ++i) add(pooled(row, i));
    add(pooled(row, std::nullopt));
    fmt::format_to(out, "\n");
}

evaluation::FreeBins pooled_free(const SeenRow& row) {
    evaluation::FreeCalibration sum;
    for (const SeenFigures* figures : row.seeds) sum.add(figures->free);
    return sum.images;
}

/// One column for each bin in which a row has voxels.
void add_free_table(std::string& text, const std::vector<SeenRow>& rows) {
    auto out = std::back_inserter(text);
    std::vector<std::size_t> bins;
    for (std::size_t i = 0; i < evaluation::kFreeBins; ++i) {
        if (std::ranges::any_of(rows, [&](const SeenRow& row) { return pooled_free(row)[i].voxels > 0; }))
            bins.push_back(i);
    }
    fmt::format_to(out, "{:<14}{:<16}{:>6}", "world", "configuration", "time s");
    for (const std::size_t i : bins)
        fmt::format_to(out, "{:>17}", i + 1 < evaluation::kFreeBins ? fmt::format("{}", i) : "more");
    for (const SeenRow& row : rows) {
        fmt::format_to(out, "\n{}", row.title);
        const auto free = pooled_free(row);
        for (const std::size_t i : bins)
            fmt::format_to(out, "{:>17}",
                           fmt::format("{} ({})", number(free[i].surface_share(), 4), free[i].voxels));
    }
    fmt::format_to(out, "\n");
}

void add_seen_tables(std::string& text, const DepthResults& results, const std::string& noise) {
    auto out = std::back_inserter(text);
    const auto rows = rows_of(results.seen, noise, seen_title);
    fmt::format_to(out, "\nnoise {}, {} camera, {} seeds: means, worst seed in brackets\n", noise,
                   results.scene == DepthScene::moving ? "moving" : "stationary", rows.front().seeds.size());
    fmt::format_to(out, "{:<14}{:<16}{:>6} {:>14}{:>10}{:>10}{:>10} {:>14}{:>10}{:>10}{:>10}{:>10}\n",
                   "world", "configuration", "time s", "precision", "tolerant", "f1_seen", "occupied", "free",
                   "unknown", "body_2cm", "body_5cm", "available");
    for (const SeenRow& row : rows) add_seen_row(text, row);
    fmt::format_to(out, "\nnoise {}: occupied / free share of seen voxels by thickness\n{:<14}{:<16}{:>6}",
                   noise, "world", "configuration", "time s");
    for (const auto thickness : evaluation::kEveryThickness)
        fmt::format_to(out, "{:>16}", evaluation::name_of(thickness));
    fmt::format_to(out, "{:>16}\n", "too_coarse");
    for (const SeenRow& row : rows) add_class_row(text, row);
    fmt::format_to(out, "\nnoise {}: surface share of free voxels (their number) by images behind them\n",
                   noise);
    add_free_table(text, rows);
}

using HandRow = Row<HandFigures>;

std::string hand_title(const HandFigures& of) {
    return fmt::format("{:<14}{:<16}{:<10}{:>6.2f}", of.subject.scenario, of.subject.label, name_of(of.path),
                       of.speed_m_per_s);
}

std::optional<double> share(std::uint64_t part, std::uint64_t whole) {
    if (whole == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(whole);
}

/// "0.30 (0.40)"; the worst is `never` if a seed has no value.
std::string time_text(const Spread& spread) {
    return fmt::format("{} ({})", number(spread.mean, 2),
                       spread.is_complete ? number(spread.most, 2) : std::string("never"));
}

void add_hand_row(std::string& text, const HandRow& row) {
    const Spread occupied =
        spread_of(row, [](const HandFigures& of) { return share(of.occupied, of.voxels); });
    const Spread free = spread_of(row, [](const HandFigures& of) { return share(of.free, of.voxels); });
    const Spread appears = spread_of(row, [](const HandFigures& of) { return of.appears_s; });
    const Spread leaves = spread_of(row, [](const HandFigures& of) { return of.leaves_s; });
    fmt::format_to(std::back_inserter(text), "{}{:>16}{:>16}{:>16}{:>16}\n", row.title,
                   fmt::format("{} ({})", number(occupied.mean), number(occupied.least)),
                   fmt::format("{} ({})", number(free.mean), number(free.most)), time_text(appears),
                   time_text(leaves));
}

void add_hand_table(std::string& text, const DepthResults& results, const std::string& noise) {
    const auto rows = rows_of(results.hand, noise, hand_title);
    fmt::format_to(std::back_inserter(text),
                   "\nnoise {}, a hand, {} seeds: means, worst seed in brackets\n"
                   "{:<14}{:<16}{:<10}{:>6}{:>16}{:>16}{:>16}{:>16}\n",
                   noise, rows.front().seeds.size(), "world", "configuration", "path", "m/s", "occupied",
                   "free", "appears s", "leaves s");
    for (const HandRow& row : rows) add_hand_row(text, row);
}

}  // namespace

std::string depth_tables(const DepthResults& results) {
    std::string text;
    for (const std::string& noise : noises_of(results.seen)) add_seen_tables(text, results, noise);
    for (const std::string& noise : noises_of(results.hand)) add_hand_table(text, results, noise);
    return text;
}

}  // namespace octoskin::depth_study
