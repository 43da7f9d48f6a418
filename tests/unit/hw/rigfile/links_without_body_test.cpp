// Links that move, can be seen and have no body, or one that covers too little: by hand, and random trees
// against an oracle that looks at the way between every two links.
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

BodylessLinks bodyless(const Rig& rig) {
    const auto body = padded_body(rig);
    EXPECT_TRUE(body) << body.error().message();
    const auto links = bodyless_links(rig, *body);
    EXPECT_TRUE(links) << links.error().message();
    return *links;
}

Names without_body(const Rig& rig) {
    return bodyless(rig).without_body;
}

/// "link of lender", for each link that another's body stands for.
Names borrowed(const Rig& rig) {
    Names names;
    for (const BorrowedBody& one : bodyless(rig).borrowed) names.push_back(one.link + " of " + one.body_of);
    return names;
}

TEST(LinksWithoutBody, of_an_arm_whose_upper_arm_alone_has_none) {
    auto rig = read_rig(kSource / "tests/data/partial_body/rig.yaml");
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(without_body(*rig), Names{"upper"}) << "the base does not move, the forearm carries the tool";
    EXPECT_EQ(borrowed(*rig), Names{"fore of tool"});
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

/// What has too little of a body can be listed as what has none can.
TEST(LinksWithoutBody, may_be_listed_if_their_body_is_too_little) {
    const testing_support::ScratchFolder folder;
    const auto listed = [&](const std::string& inside) {
        folder.write("arm.urdf", "<robot name=\"arm\"><link name=\"base\"/><link name=\"upper\">" + inside +
                                     "</link><joint name=\"j1\" type=\"revolute\"><parent link=\"base\"/>"
                                     "<child link=\"upper\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" "
                                     "upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>\n");
        return read_rig(
            folder.write("rig.yaml", "extends: " + (kSource / "tests/data/rigs/one-sensor.yaml").string() +
                                         "\nrobot: {urdf: arm.urdf, links_without_body: [upper]}\n"
                                         "joints: {names: [j1]}\nsensor_defaults: {link: upper}\n"));
    };
    const std::string box = "<visual><geometry><box size=\"0.4 0.1 0.1\"/></geometry></visual>";
    const auto speck = listed(box + "<collision><geometry><sphere radius=\"0.001\"/></geometry></collision>");
    ASSERT_TRUE(speck) << speck.error().message();
    EXPECT_EQ(without_body(*speck), Names{"upper"});
    const auto ball = listed(box + "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>");
    ASSERT_FALSE(ball);
    EXPECT_EQ(ball.error().code, ErrorCode::conflict);
    EXPECT_EQ(ball.error().line, 2);
    EXPECT_EQ(ball.error().key, "robot.links_without_body");
    const auto mesh = listed(box + "<collision><geometry><mesh filename=\"m.dae\"/></geometry></collision>");
    // Capsules are fitted later, by commands that use the body.
    ASSERT_TRUE(mesh) << mesh.error().message();
    EXPECT_EQ(padded_body(*mesh).error().code, ErrorCode::unsupported);
}

TEST(LinksWithoutBody, of_no_rig_that_ships) {
    int rigs = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kSource / "hw/rigs")) {
        if (entry.path().extension() != ".yaml") continue;
        const auto rig = read_rig(entry.path());
        ASSERT_TRUE(rig) << rig.error().message();
        EXPECT_EQ(without_body(*rig), Names()) << entry.path();
        EXPECT_EQ(borrowed(*rig), Names()) << entry.path();
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
    /// Those without a capsule of their own that are not among `expected()`.
    [[nodiscard]] Names expected_to_borrow() const {
        const Names without = expected();
        Names names;
        for (std::size_t i = 0; i < links_.size(); ++i) {
            const bool has_own = links_[i].has_collision || links_[i].has_attached;
            if (!is_below_base(i) || !links_[i].has_visual || is_rigid_between(i, base_) || has_own) continue;
            if (std::ranges::count(without, name_of(i)) == 0) names.push_back(name_of(i));
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
        const BodylessLinks found = bodyless(rig);
        ASSERT_EQ(found.without_body, expected) << "case " << i << ": " << tree.text();
        Names borrowing;
        for (const BorrowedBody& one : found.borrowed) borrowing.push_back(one.link);
        ASSERT_EQ(borrowing, tree.expected_to_borrow()) << "case " << i << ": " << tree.text();
        ++(expected.empty() ? without : named);
    }
    EXPECT_GT(named, 50) << "cases in which there is something to name";
    EXPECT_GT(without, 50);
}

const std::string kMesh = R"(<visual><geometry><mesh filename="m.dae"/></geometry></visual>)";

std::string cylinder(const std::string& tag, double from_x, double to_x, double radius_m) {
    return "<" + tag + "><origin xyz=\"" + std::to_string(0.5 * (from_x + to_x)) +
           " 0 0\" rpy=\"0 1.5707963 0\"/><geometry><cylinder radius=\"" + std::to_string(radius_m) +
           "\" length=\"" + std::to_string(to_x - from_x) + "\"/></geometry></" + tag + ">";
}
std::string ball(const std::string& tag, double radius_m) {
    return "<" + tag + "><geometry><sphere radius=\"" + std::to_string(radius_m) + "\"/></geometry></" + tag +
           ">";
}
std::string box(const std::string& tag, double x_m, double y_m, double z_m) {
    return "<" + tag + "><geometry><box size=\"" + std::to_string(x_m) + " " + std::to_string(y_m) + " " +
           std::to_string(z_m) + "\"/></geometry></" + tag + ">";
}
std::string link(const std::string& name, const std::string& inside) {
    return "<link name=\"" + name + "\">" + inside + "</link>\n";
}
std::string joint(const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& xyz, const std::string& axis = "0 0 1") {
    return "<joint name=\"to_" + child + "\" type=\"" + type + "\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/><origin xyz=\"" + xyz + "\"/><axis xyz=\"" + axis +
           "\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>\n";
}

/// An upper arm along x with a bolt fixed to its middle.
struct UpperArm {
    std::string upper;                 ///< what is in that link
    std::string bolt;                  ///< and in that one
    std::string forearm_at = "0 0 0";  ///< the next joint; its axis is
    std::string forearm_axis = "0 0 1";
    std::string moved_by = "revolute";

    [[nodiscard]] Rig rig(const testing_support::ScratchFolder& folder) const {
        Rig rig;
        rig.base_link = "base";
        rig.urdf = folder.write(
            "arm.urdf", "<robot name=\"arm\">\n" + link("base", "") + link("upper", upper) +
                            link("bolt", bolt) + link("fore", kMesh + cylinder("collision", 0, 0.4, 0.05)) +
                            joint(moved_by, "base", "upper", "0 0 0.2") +
                            joint("fixed", "upper", "bolt", "0.25 0 0.05") +
                            joint("revolute", "upper", "fore", forearm_at, forearm_axis) + "</robot>\n");
        return rig;
    }
};

struct CoverCase {
    const char* name;
    UpperArm arm;
    Names without;
    Names borrowed;
};

const std::string kSpeck = ball("collision", 0.001);
const std::string kRod = cylinder("visual", 0.0, 0.5, 0.05);

const std::vector<CoverCase> kCovers = {
    {"a speck on a bolt is no body of the rod that it is fixed to",
     {kRod, kMesh + kSpeck},
     {"bolt", "upper"},
     {}},
    {"nor where the bolt is covered by it", {kRod, ball("visual", 0.001) + kSpeck}, {"upper"}, {}},
    {"a speck on the rod itself is none either", {kRod + kSpeck, ""}, {"upper"}, {}},
    {"half of the rod's length is enough", {kRod + cylinder("collision", 0.0, 0.251, 0.05), ""}, {}, {}},
    {"less is not", {kRod + cylinder("collision", 0.01, 0.249, 0.001), ""}, {"upper"}, {}},
    {"from two pieces that lap, each metre counts once",
     {kRod + cylinder("collision", 0.1, 0.25, 0.001) + cylinder("collision", 0.12, 0.25, 0.001), ""},
     {"upper"},
     {}},
    {"a body that lies far beside the rod is none of it",
     {kRod,
      "<collision><origin xyz=\"0.0 0.4 0\" rpy=\"0 1.5707963 0\"/><geometry><cylinder radius=\"0.05\" "
      "length=\"0.5\"/></geometry></collision>"},
     {"upper"},
     {}},
    {"the body may be the bolt's", {kRod, cylinder("collision", -0.25, 0.25, 0.05)}, {}, {"upper of bolt"}},
    {"a mount without a body is the arm's, and told",
     {kRod + cylinder("collision", 0.0, 0.5, 0.05), box("visual", 0.05, 0.05, 0.08)},
     {},
     {"bolt of upper"}},
    {"a mount that is a mesh too",
     {kMesh + cylinder("collision", 0.0, 0.5, 0.05), kMesh},
     {},
     {"bolt of upper"}},
    {"a boom that is longer than the arm is not",
     {cylinder("visual", 0.0, 0.2, 0.05) + cylinder("collision", 0.0, 0.2, 0.05),
      box("visual", 0.02, 0.02, 0.9)},
     {"bolt"},
     {}},
    {"a speck for an arm that is a mesh", {kMesh, kMesh + kSpeck}, {"bolt", "upper"}, {}},
    {"and many of them", {kMesh, kSpeck + kSpeck + kSpeck + kSpeck}, {"upper"}, {}},
    {"a ball of 4.8 cm", {kMesh, ball("collision", 0.024)}, {"upper"}, {}},
    {"a ball of 6 cm for one of unknown size", {kMesh, ball("collision", 0.03)}, {}, {"upper of bolt"}},
    {"a ball of 6 cm, and the next axis is parallel and 50 cm on",
     {kMesh, ball("collision", 0.03), "0.5 0 0"},
     {"upper"},
     {}},
    {"the same on the arm itself", {kMesh + ball("collision", 0.03), "", "0.5 0 0"}, {"upper"}, {}},
    {"a bracket of 20 cm", {kMesh, cylinder("collision", -0.1, 0.1, 0.02), "0.5 0 0"}, {"upper"}, {}},
    {"one of 26 cm", {kMesh, cylinder("collision", -0.13, 0.13, 0.02), "0.5 0 0"}, {}, {"upper of bolt"}},
    {"the axes are 50 cm from each other, wherever their joints are",
     {kMesh, cylinder("collision", -0.1, 0.1, 0.02), "0.5 0 0.7"},
     {"upper"},
     {}},
    {"axes that meet say nothing of a link's own body",
     {kMesh + ball("collision", 0.06), "", "0.5 0 0", "1 0 0"},
     {},
     {}},
    {"of another's body they say that a ball of 6 cm is too little",
     {kMesh, ball("collision", 0.03), "0.5 0 0", "1 0 0"},
     {"upper"},
     {}},
    {"and that one of 12 cm is not",
     {kMesh, ball("collision", 0.06), "0.5 0 0", "1 0 0"},
     {},
     {"upper of bolt"}},
    {"a slide's joints may be anywhere",
     {kMesh, ball("collision", 0.03), "0.5 0 0", "0 0 1", "prismatic"},
     {},
     {"upper of bolt"}},
    {"a link that is seen whole is whole, though its axes are apart",
     {ball("visual", 0.05) + ball("collision", 0.05), "", "0.5 0 0"},
     {},
     {}},
    {"a rod in millimetres by mistake",
     {cylinder("visual", 0.0, 500.0, 50.0) + cylinder("collision", 0.0, 0.5, 0.05), ""},
     {"upper"},
     {}},
    {"nothing is seen", {"", kSpeck, "0.5 0 0"}, {}, {}},
};

TEST(LinksWithoutBody, have_one_that_covers_a_useful_part_of_what_is_seen) {
    const testing_support::ScratchFolder folder;
    for (const CoverCase& one : kCovers) {
        const Rig rig = one.arm.rig(folder);
        EXPECT_EQ(without_body(rig), one.without) << one.name;
        EXPECT_EQ(borrowed(rig), one.borrowed) << one.name;
    }
}

/// Padding is body: what it covers is asked about, and taken out.
TEST(LinksWithoutBody, are_covered_by_padding) {
    const testing_support::ScratchFolder folder;
    Rig rig = UpperArm{kRod + ball("collision", 0.01), ""}.rig(folder);
    EXPECT_EQ(without_body(rig), Names{"upper"});
    rig.link_padding_m["upper"] = 0.25;
    EXPECT_EQ(without_body(rig), Names());
}

/// Of thousands of little ones (a cable chain, a heat sink) the hundred longest decide.
TEST(LinksWithoutBody, of_many_visuals_are_found_at_once) {
    const testing_support::ScratchFolder folder;
    std::string screws;
    for (int i = 0; i < 20'000; ++i) screws += ball("visual", 0.002);
    std::string balls;
    for (int i = 0; i < 1000; ++i) balls += ball("collision", 0.001);
    EXPECT_EQ(without_body(UpperArm{kRod + balls, screws}.rig(folder)), Names({"bolt", "upper"}));
    const std::string whole = cylinder("collision", 0.0, 0.5, 0.05);
    EXPECT_EQ(without_body(UpperArm{kRod + whole, screws}.rig(folder)), Names());
}

/// The arm that ships, drawn with meshes: with its capsules on the links that have the meshes, and, as its
/// vendor has it, on links of their own that are fixed to them.
TEST(LinksWithoutBody, of_the_panda_are_none_whether_its_capsules_are_on_its_links_or_beside_them) {
    const testing_support::ScratchFolder folder;
    auto rig = read_rig(kSource / "hw/rigs/experiment.yaml");
    ASSERT_TRUE(rig) << rig.error().message();
    const std::string shipped = testing_support::ScratchFolder::read(kSource / "hw/robots/panda.urdf");
    std::string drawn = shipped;
    for (std::size_t at = 0; (at = drawn.find("<link name=\"panda_link", at)) != std::string::npos; ++at) {
        const std::size_t end = drawn.find('>', at);
        if (drawn[end - 1] != '/') drawn.insert(end + 1, kMesh);
    }
    rig->urdf = folder.write("drawn.urdf", drawn);
    EXPECT_EQ(without_body(*rig), Names());
    EXPECT_EQ(borrowed(*rig), Names());
    std::string beside = shipped;
    int moved = 0;
    for (std::size_t at = 0; (at = beside.find("<link name=\"panda_link", at)) != std::string::npos;) {
        const std::size_t end = beside.find('>', at);
        const std::string name = beside.substr(at + 12, beside.find('"', at + 12) - at - 12);
        if (beside[end - 1] != '/') {
            const std::string more = link(name, kMesh) + joint("fixed", name, name + "_sc", "0 0 0");
            beside.insert(at, more);
            at += more.size();
            beside.insert(at + 12 + name.size(), "_sc");
            ++moved;
        }
        ++at;
    }
    ASSERT_GE(moved, 8);
    rig->urdf = folder.write("beside.urdf", beside);
    EXPECT_EQ(without_body(*rig), Names());
    EXPECT_EQ(borrowed(*rig).size(), static_cast<std::size_t>(moved - 1)) << "all but the base";
    EXPECT_EQ(borrowed(*rig).front(), "panda_link1 of panda_link1_sc");
}

}  // namespace
}  // namespace octoskin::rig
