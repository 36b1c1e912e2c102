// Counts the instructions that a program runs in qemu's user emulation, for any processor, and tells on stderr:
//   qemu-aarch64 -plugin libinstructions.so -L SYSROOT PROGRAM
// Debian's qemu takes plugins but ships no header for them; what is needed of the interface (version 1, of qemu 4.2 to
// 8) is declared here. cost.sh says what the count is for.
#include <cstddef>
#include <cstdint>
#include <cstdio>

extern "C" {
struct qemu_plugin_tb;
using TranslationCallback = void (*)(std::uint64_t plugin, qemu_plugin_tb* block);
using ExitCallback = void (*)(std::uint64_t plugin, void* data);
void qemu_plugin_register_vcpu_tb_trans_cb(std::uint64_t plugin, TranslationCallback callback);
void qemu_plugin_register_vcpu_tb_exec_inline(qemu_plugin_tb* block, int add_64_bits, void* counter, std::uint64_t by);
void qemu_plugin_register_atexit_cb(std::uint64_t plugin, ExitCallback callback, void* data);
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb* block);

// NOLINTNEXTLINE(readability-identifier-naming): qemu's name
[[gnu::visibility("default")]] extern const int qemu_plugin_version;
const int qemu_plugin_version = 1;
[[gnu::visibility("default")]] int qemu_plugin_install(std::uint64_t plugin, const void* machine, int argc,
                                                       char** argv);
}

namespace {

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): what qemu translates adds to it
std::uint64_t instructions = 0;

void on_translation(std::uint64_t /*plugin*/, qemu_plugin_tb* block) {
    qemu_plugin_register_vcpu_tb_exec_inline(block, 0, &instructions, qemu_plugin_tb_n_insns(block));
}

void on_exit(std::uint64_t /*plugin*/, void* /*data*/) {
    std::fprintf(stderr, "instructions: %llu\n", static_cast<unsigned long long>(instructions));
}

}  // namespace

int qemu_plugin_install(std::uint64_t plugin, const void* /*machine*/, int /*argc*/, char** /*argv*/) {
    qemu_plugin_register_vcpu_tb_trans_cb(plugin, on_translation);
    qemu_plugin_register_atexit_cb(plugin, on_exit, nullptr);
    return 0;
}
