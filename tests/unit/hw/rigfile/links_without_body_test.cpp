// Links that move, can be seen and have no body: by hand, and random trees against an oracle that looks at
// the way between every two links.
#include "hw/rigfile/links_without_body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "tests/support/cases.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using Names = std::vector<std::string>;

const std::filesystem::path kSource = OCTOSKIN_SOURCE_DIR;

Names without_body(const Rig& rig) {
    const auto body = padded_body(rig);
    EXPECT_TRUE(body) << body.error().message();
    const auto names = links_without_body(rig, *body);
    EXPECT_TRUE(names) << names.error().message();
    return *names;
}

TEST(LinksWithoutBody, of_an_arm_whose_upper_arm_alone_has_none) {
    auto rig = read_rig(kSource / "tests/data/partial_body/rig.yaml");
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(without_body(*rig), Names{"upper"}) << "the base does not move, the forearm carries the tool";
    rig->attached_capsules.push_back({"hose", "upper", {0, 0, 0}, {0.5, 0, 0}, 0.05, 0.0});
    EXPECT_EQ(without_body(*rig), Names()) << "an attached capsule is a body";
    rig->attached_capsules.clear();
    rig->urdf = kSource / "tests/data/partial_body/arm_whole.urdf";
    EXPECT_EQ(without_body(*rig), Names());
}

TEST(LinksWithoutBody, are_the_same_whether_the_rig_lists_them_or_not) {
    const auto rig = read_rig(kSource / "tests/data/partial_body/listed.yaml");
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(rig->links_without_body, Names{"upper"});
    EXPECT_EQ(without_body(*rig), Names{"upper"});
}

TEST(LinksWithoutBody, of_no_rig_that_ships) {
    int rigs = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kSource / "hw/rigs")) {
        if (entry.path().extension() != ".yaml") continue;
        const auto rig = read_rig(entry.path());
        ASSERT_TRUE(rig) << rig.error().message();
        EXPECT_EQ(without_body(*rig), Names()) << entry.path();
        EXPECT_EQ(rig->links_without_body, Names()) << entry.path();
        ++rigs;
    }
    EXPECT_GE(rigs, 13);
}

struct TreeLink {
    std::size_t parent = 0;  ///< of link 0, itself
    bool is_fixed = false;   ///< how it hangs from there
    bool has_visual = false;
    bool has_collision = false;
    bool has_attached = false;
};

std::string name_of(std::size_t link) {
    return "link" + std::to_string(link);
}

class Tree {
  public:
    explicit Tree(std::mt19937& random) {
        const auto is_so = [&](double probability) {
            return std::bernoulli_distribution(probability)(random);
        };
        links_.resize(std::uniform_int_distribution<std::size_t>(1, 12)(random));
        const double share_with_body = std::uniform_real_distribution<double>(0.0, 0.6)(random);
        for (std::size_t i = 0; i < links_.size(); ++i) {
            const std::size_t parent =
                i == 0 ? 0 : std::uniform_int_distribution<std::size_t>(0, i - 1)(random);
            links_[i] = {parent, is_so(0.5), is_so(0.6), is_so(share_with_body), is_so(0.1)};
        }
        base_ = std::uniform_int_distribution<std::size_t>(
            0, std::min<std::size_t>(2, links_.size() - 1))(random);
        // A body above the base is an error of its own.
        for (std::size_t i = 0; i < links_.size(); ++i)
            if (!is_below_base(i)) links_[i].has_collision = links_[i].has_attached = false;
    }

    [[nodiscard]] std::string urdf(std::mt19937& random) const {
        std::vector<std::string> elements;
        for (std::size_t i = 0; i < links_.size(); ++i) {
            std::string link = "<link name=\"" + name_of(i) + "\">";
            if (links_[i].has_visual)
                link += "<visual><geometry><mesh filename=\"m.dae\"/></geometry></visual>";
            if (links_[i].has_collision)
                link += "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>";
            elements.push_back(link + "</link>\n");
            if (i > 0) elements.push_back(joint(i));
        }
        std::ranges::shuffle(elements, random);
        std::string text = "<robot name=\"tree\">\n";
        for (const std::string& element : elements) text += element;
        return text + "</robot>\n";
    }

    [[nodiscard]] Rig rig(const std::filesystem::path& file) const {
        Rig rig;
        rig.urdf = file;
        rig.base_link = name_of(base_);
        for (std::size_t i = 0; i < links_.size(); ++i)
            if (links_[i].has_attached)
                rig.attached_capsules.push_back({.name = name_of(i), .link = name_of(i), .radius_m = 0.1});
        return rig;
    }

    /// By looking at the way between every two links.
    [[nodiscard]] Names expected() const {
        Names names;
        for (std::size_t i = 0; i < links_.size(); ++i) {
            if (!is_below_base(i) || !links_[i].has_visual || is_rigid_between(i, base_)) continue;
            bool is_covered = false;
            for (std::size_t j = 0; j < links_.size(); ++j)
                is_covered |= (links_[j].has_collision || links_[j].has_attached) && is_rigid_between(i, j);
            if (!is_covered) names.push_back(name_of(i));
        }
        std::ranges::sort(names);
        return names;
    }
    [[nodiscard]] std::string text() const {
        std::string text = "base " + name_of(base_);
        for (const TreeLink& link : links_)
            text += "; " + std::to_string(link.parent) + (link.is_fixed ? " fixed" : " turns") +
                    (link.has_visual ? " visual" : "") + (link.has_collision ? " collision" : "") +
                    (link.has_attached ? " attached" : "");
        return text;
    }

  private:
    [[nodiscard]] std::string joint(std::size_t link) const {
        const std::string type = links_[link].is_fixed ? "fixed" : link % 2 == 0 ? "continuous" : "prismatic";
        return "<joint name=\"joint" + std::to_string(link) + "\" type=\"" + type + "\"><parent link=\"" +
               name_of(links_[link].parent) + "\"/><child link=\"" + name_of(link) +
               "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" "
               "velocity=\"1\"/></joint>\n";
    }
    /// It and all above it, up to the root.
    [[nodiscard]] std::vector<std::size_t> way_up(std::size_t link) const {
        std::vector<std::size_t> way = {link};
        while (way.back() != 0) way.push_back(links_[way.back()].parent);
        return way;
    }
    [[nodiscard]] bool is_below_base(std::size_t link) const {
        return std::ranges::count(way_up(link), base_) > 0;
    }
    /// All joints on the way from one to the other are fixed: those that hang what is above one of them only.
    [[nodiscard]] bool is_rigid_between(std::size_t a, std::size_t b) const {
        const auto up_a = way_up(a);
        const auto up_b = way_up(b);
        const auto is_free_of = [this](const auto& way, const auto& other) {
            return std::ranges::all_of(way, [&](std::size_t link) {
                return std::ranges::count(other, link) > 0 || links_[link].is_fixed;
            });
        };
        return is_free_of(up_a, up_b) && is_free_of(up_b, up_a);
    }

    std::vector<TreeLink> links_;
    std::size_t base_ = 0;
};

TEST(LinksWithoutBody, of_random_trees_are_those_that_a_look_at_every_way_finds) {
    const testing_support::ScratchFolder folder;
    std::mt19937 random(20'260'112);
    int named = 0;
    int without = 0;
    for (unsigned i = 0; i < testing_support::cases(1'500); ++i) {
        const Tree tree(random);
        const Rig rig = tree.rig(folder.write("tree.urdf", tree.urdf(random)));
        const Names expected = tree.expected();
        ASSERT_EQ(without_body(rig), expected) << "case " << i << ": " << tree.text();
        ++(expected.empty() ? without : named);
    }
    EXPECT_GT(named, 50) << "cases in which there is something to name";
    EXPECT_GT(without, 50);
}

}  // namespace
}  // namespace octoskin::rig
