# Debian 12 on arm64 (a Raspberry Pi), cross-compiled on amd64 with the packages of [arm64] in scripts/packages.txt. Programs that the build
# runs run under qemu.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)

# libmuparser-dev cannot be installed for two architectures at once: its headers are those of amd64, and this replaces its other files.
get_property(trying GLOBAL PROPERTY IN_TRY_COMPILE)
if(NOT trying)
  set(muparser ${CMAKE_BINARY_DIR}/muparser)
  file(WRITE ${muparser}/muparser.pc "Name: muparser\nDescription: for arm64\nVersion: 2.3.3\nLibs: -L${muparser} -lmuparser\n")
  file(CREATE_LINK /usr/lib/aarch64-linux-gnu/libmuparser.so.2 ${muparser}/libmuparser.so SYMBOLIC)
  set(CMAKE_EXE_LINKER_FLAGS_INIT -L${muparser})  # for programs that link libecs.a by find_package(ecs)
  set(ENV{PKG_CONFIG_LIBDIR} ${muparser}:/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig)
endif()
