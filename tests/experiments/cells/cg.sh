for s in ball-on-cube-press hertz-sphere sphere-on-sphere-body; do for t in main cells; do
 n=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='touchstone::fast::step(*' /work/$t/build/release/touchstone-fast fast /work/main/meshes/scenes/$s.toml --out /tmp/cc/o_$t_$s 2>&1 | grep Collected | awk '{print $4}'); echo $s $t $n; done; done
