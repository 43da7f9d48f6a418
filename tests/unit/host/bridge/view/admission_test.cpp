// Which handshakes the view takes.
#include "host/bridge/view/admission.hpp"

#include <gtest/gtest.h>

namespace octoskin::view {
namespace {

const Admission kLocal("127.0.0.1", 8765, {"https://app.foxglove.dev", "file://"});

TEST(Admission, takes_names_of_this_machine_with_the_port) {
    for (const char* const host : {"localhost:8765", "127.0.0.1:8765", "[::1]:8765", "LocalHost:8765"})
        EXPECT_TRUE(kLocal.takes_host(host)) << host;
    for (const char* const host : {"", "localhost", "localhost:8766", "evil.example:8765", "127.0.0.2:8765",
                                   "localhost.evil.example:8765", "localhost:8765:8765", "localhost:8765 "})
        EXPECT_FALSE(kLocal.takes_host(host)) << host;
}

TEST(Admission, takes_the_host_of_the_option_and_port_80_left_out) {
    const Admission named("Robot.Local", 80, {});
    for (const char* const host : {"robot.local", "robot.local:80", "localhost"})
        EXPECT_TRUE(named.takes_host(host)) << host;
    EXPECT_TRUE(named.takes_origin("http://robot.local"));
    EXPECT_TRUE(Admission("fe80::1", 8765, {}).takes_host("[fe80::1]:8765"));
    EXPECT_TRUE(Admission("[fe80::1]", 8765, {}).takes_host("[fe80::1]:8765"));
}

TEST(Admission, takes_no_origin_its_own_and_those_of_the_option) {
    EXPECT_TRUE(kLocal.takes_origin(std::nullopt));
    for (const char* const origin : {"http://localhost:8765", "http://127.0.0.1:8765", "http://[::1]:8765",
                                     "https://app.foxglove.dev", "file://"})
        EXPECT_TRUE(kLocal.takes_origin(origin)) << origin;
    for (const char* const origin :
         {"", "null", "NULL", "http://evil.example", "https://localhost:8765", "http://localhost:3000",
          "http://localhost", "http://app.foxglove.dev", "https://app.foxglove.dev.evil.example",
          "https://app.foxglove.dev/", "https://app.foxglove.dev, http://evil.example"})
        EXPECT_FALSE(kLocal.takes_origin(origin)) << origin;
}

TEST(Admission, takes_null_from_no_option) {
    EXPECT_FALSE(Admission("127.0.0.1", 1, {"null"}).takes_origin("null"));
    EXPECT_FALSE(is_origin("null"));
}

TEST(Admission, knows_origins_from_addresses) {
    for (const char* const origin : {"https://app.foxglove.dev", "http://localhost:8080", "file://",
                                     "http://[::1]:8080", "vscode-webview://abc"})
        EXPECT_TRUE(is_origin(origin)) << origin;
    for (const char* const text : {"", "*", "app.foxglove.dev", "https://", "https://a/", "https://a/b",
                                   "https://a b", "://a", "https://*.foxglove.dev", "ht tp://a"})
        EXPECT_FALSE(is_origin(text)) << text;
}

TEST(Admission, takes_the_first_subprotocol_that_it_has) {
    EXPECT_EQ(Admission::subprotocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
    EXPECT_EQ(Admission::subprotocol("foxglove.sdk.v1, foxglove.websocket.v1"), "foxglove.sdk.v1");
    EXPECT_EQ(Admission::subprotocol("chat ,\tfoxglove.websocket.v1\t,foxglove.sdk.v1"),
              "foxglove.websocket.v1");
    for (const char* const offered : {"", ",", "foxglove.websocket.v2", "foxglove", "foxglove.sdk.v1x"})
        EXPECT_FALSE(Admission::subprotocol(offered)) << offered;
}

}  // namespace
}  // namespace octoskin::view
