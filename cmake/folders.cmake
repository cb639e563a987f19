# Every folder of the libraries and what it may include: folders by their path, packages by their target. A new folder gets
# its line here; scripts/check_includes holds the sources to these lines.

ecs_folder(base PkgConfig::nettle ZLIB::ZLIB fmt::fmt nlohmann_json::nlohmann_json tl::expected
           tomlplusplus::tomlplusplus)
ecs_folder(base/cli base CLI11::CLI11 fmt::fmt)
ecs_folder(base/linear PkgConfig::Eigen3)
ecs_folder(base/xml base PkgConfig::libxml2 fmt::fmt)

ecs_folder(core base ZLIB::ZLIB)

ecs_folder(kinematics core)

ecs_folder(params base core kinematics fmt::fmt tomlplusplus::tomlplusplus)

ecs_folder(laser base core fmt::fmt)
ecs_folder(laser/analysis base base/linear core laser PkgConfig::Eigen3 fmt::fmt)
ecs_folder(laser/import base base/linear core laser laser/writers PkgConfig::Eigen3 fmt::fmt)
ecs_folder(laser/map base core laser laser/analysis laser/import fmt::fmt)
ecs_folder(laser/standards base base/linear core laser laser/analysis PkgConfig::Eigen3 fmt::fmt)
ecs_folder(laser/writers base laser fmt::fmt)

ecs_folder(volume base core kinematics laser laser/map fmt::fmt)

ecs_folder(model/data base core kinematics laser laser/import laser/map laser/standards params fmt::fmt)
ecs_folder(model/diagnosis base base/linear laser model/data model/effects model/fit model/regression
           PkgConfig::Eigen3 fmt::fmt)
ecs_folder(model/effects base core laser laser/analysis model/data PkgConfig::Eigen3 fmt::fmt)
ecs_folder(model/fit base base/linear core laser laser/import laser/map model/data model/effects model/regression
           params PkgConfig::Eigen3 fmt::fmt)
ecs_folder(model/planning base base/linear laser laser/writers model/data model/diagnosis model/effects model/fit
           model/regression params PkgConfig::Eigen3 fmt::fmt)
ecs_folder(model/regression base base/linear model/data model/effects PkgConfig::Eigen3 PkgConfig::muparser fmt::fmt)

ecs_folder(protocol/client base core protocol/line protocol/registers PkgConfig::modbus Threads::Threads fmt::fmt)
ecs_folder(protocol/line base protocol/registers PkgConfig::modbus Threads::Threads fmt::fmt tl::expected)
ecs_folder(protocol/registers base core PkgConfig::sodium fmt::fmt tl::expected)
ecs_folder(protocol/server base core protocol/line protocol/registers fmt::fmt)

ecs_folder(ecs_emulator/drive base core ecs_emulator/random)
ecs_folder(ecs_emulator/effects base core)
ecs_folder(ecs_emulator/errors base core ecs_emulator/effects ecs_emulator/random ecs_emulator/settings
           ecs_emulator/thermal params PkgConfig::Eigen3 PkgConfig::muparser fmt::fmt)
ecs_folder(ecs_emulator/instruments base core ecs_emulator/errors ecs_emulator/machine ecs_emulator/random
           ecs_emulator/settings ecs_emulator/thermal laser laser/writers fmt::fmt nlohmann_json::nlohmann_json)
ecs_folder(ecs_emulator/machine base core ecs_emulator/drive ecs_emulator/errors ecs_emulator/random
           ecs_emulator/settings ecs_emulator/thermal params)
ecs_folder(ecs_emulator/part_programs base core ecs_emulator/instruments ecs_emulator/machine fmt::fmt
           nlohmann_json::nlohmann_json)
ecs_folder(ecs_emulator/random)
ecs_folder(ecs_emulator/settings base core ecs_emulator/drive params fmt::fmt)
ecs_folder(ecs_emulator/thermal base core ecs_emulator/random)
ecs_folder(ecs_emulator/unit base core ecs_emulator/machine protocol/server Threads::Threads fmt::fmt)
ecs_folder(ecs_emulator/verbs base base/cli ecs_emulator/instruments ecs_emulator/part_programs ecs_emulator/unit
           ecs_emulator/workshop fmt::fmt nlohmann_json::nlohmann_json)
ecs_folder(ecs_emulator/workshop base ecs_emulator/instruments ecs_emulator/machine ecs_emulator/part_programs
           ecs_emulator/unit laser laser/writers protocol/line protocol/server PkgConfig::Eigen3 fmt::fmt
           nlohmann_json::nlohmann_json)

ecs_folder(commissioning/files base commissioning/laser_session commissioning/memory model/fit fmt::fmt)
ecs_folder(commissioning/laser_session base base/cli commissioning/link commissioning/maps commissioning/measurements
           commissioning/plot commissioning/session core laser laser/analysis laser/import laser/map laser/writers
           params fmt::fmt)
ecs_folder(commissioning/link base commissioning/session commissioning/unit core protocol/client protocol/line
           protocol/registers Threads::Threads fmt::fmt tomlplusplus::tomlplusplus)
ecs_folder(commissioning/maps base base/cli commissioning/link commissioning/measurements commissioning/models
           commissioning/session commissioning/unit core kinematics laser laser/map model/effects model/fit params
           protocol/client volume fmt::fmt)
ecs_folder(commissioning/measurements base base/cli commissioning/link commissioning/session core laser laser/analysis
           laser/import laser/map laser/standards Threads::Threads fmt::fmt tomlplusplus::tomlplusplus)
ecs_folder(commissioning/memory base commissioning/session commissioning/unit core laser/map params protocol/client
           protocol/registers fmt::fmt)
ecs_folder(commissioning/model_session base commissioning/link commissioning/maps commissioning/measurements
           commissioning/models commissioning/plot commissioning/session model/diagnosis model/planning fmt::fmt)
ecs_folder(commissioning/models base commissioning/measurements commissioning/plot commissioning/session core laser
           laser/map laser/standards model/data model/diagnosis model/effects model/fit model/regression params
           fmt::fmt)
ecs_folder(commissioning/parameters base commissioning/link commissioning/session commissioning/unit core params
           fmt::fmt)
ecs_folder(commissioning/plot base commissioning/session core laser laser/analysis laser/map fmt::fmt)
ecs_folder(commissioning/session base Threads::Threads fmt::fmt)
ecs_folder(commissioning/unit base core laser laser/map params protocol/client protocol/registers fmt::fmt)
ecs_folder(commissioning/utility base commissioning/link commissioning/plot commissioning/session commissioning/unit
           core params protocol/client Threads::Threads fmt::fmt)
ecs_folder(commissioning/volume base base/cli commissioning/link commissioning/maps commissioning/models
           commissioning/plot commissioning/session laser laser/map model/effects model/fit model/regression params
           volume fmt::fmt nlohmann_json::nlohmann_json)

ecs_folder(app/cli app/names base base/cli commissioning/link commissioning/session commissioning/unit core fmt::fmt)
ecs_folder(app/names)
ecs_folder(app/plot app/names base commissioning/plot fmt::fmt)
ecs_folder(app/screens app/cli app/screens/forms app/screens/laser app/screens/memory app/screens/model
           app/screens/parameters app/screens/unit app/screens/utility app/ui app/verbs base commissioning/files
           commissioning/link commissioning/session core fmt::fmt)
ecs_folder(app/screens/files app/ui base commissioning/files commissioning/link commissioning/session fmt::fmt)
ecs_folder(app/screens/forms app/cli app/screens/files app/ui app/verbs base commissioning/files commissioning/link
           commissioning/plot commissioning/session commissioning/unit commissioning/utility commissioning/volume core
           protocol/client fmt::fmt)
ecs_folder(app/screens/laser app/plot app/screens/files app/ui base commissioning/files commissioning/laser_session
           commissioning/maps commissioning/measurements commissioning/plot commissioning/session
           commissioning/utility laser/map params fmt::fmt)
ecs_folder(app/screens/memory app/screens/files app/ui base commissioning/link commissioning/memory
           commissioning/session commissioning/utility fmt::fmt)
ecs_folder(app/screens/model app/cli app/plot app/screens/files app/ui base commissioning/files commissioning/link
           commissioning/model_session commissioning/models commissioning/session laser/map model/effects fmt::fmt)
ecs_folder(app/screens/parameters app/screens/files app/ui base commissioning/link commissioning/parameters
           commissioning/session fmt::fmt)
ecs_folder(app/screens/unit app/cli app/plot app/screens/files app/screens/utility app/ui base commissioning/link
           commissioning/plot commissioning/session commissioning/unit core params fmt::fmt)
ecs_folder(app/screens/utility app/plot app/screens/files app/screens/forms app/ui base commissioning/files
           commissioning/link commissioning/memory commissioning/plot commissioning/session commissioning/unit
           commissioning/utility core params fmt::fmt)
ecs_folder(app/ui app/names base commissioning/plot commissioning/session PkgConfig::ncursesw PkgConfig::utf8proc
           fmt::fmt)
ecs_folder(app/verbs app/cli app/plot base base/cli commissioning/link commissioning/measurements commissioning/unit
           commissioning/volume fmt::fmt)
ecs_folder(app/verbs/laser app/cli app/plot base commissioning/laser_session commissioning/measurements
           commissioning/plot commissioning/session laser/analysis laser/import laser/map laser/standards
           laser/writers Threads::Threads fmt::fmt)
ecs_folder(app/verbs/map app/cli app/plot base commissioning/maps commissioning/measurements commissioning/plot
           commissioning/unit laser/map laser/writers params volume fmt::fmt)
ecs_folder(app/verbs/memory app/cli base commissioning/memory commissioning/session commissioning/unit fmt::fmt)
ecs_folder(app/verbs/model app/cli app/plot base commissioning/measurements commissioning/models commissioning/plot
           commissioning/session commissioning/volume laser/writers model/diagnosis model/effects model/fit
           model/planning volume fmt::fmt)
ecs_folder(app/verbs/params app/cli base commissioning/parameters commissioning/session commissioning/unit core params
           fmt::fmt)
ecs_folder(app/verbs/unit app/cli base commissioning/link commissioning/unit fmt::fmt)
ecs_folder(app/verbs/utility app/cli base commissioning/session commissioning/unit core params protocol/registers
           fmt::fmt)
