# Writes mallet-along-ellipsoid.csv beside it: awk -f mallet-along-ellipsoid.awk > mallet-along-ellipsoid.csv
#
# The tail's half ball is let down along the ellipsoid's normal to its depth, rests, and then keeps that depth while its
# point of contact goes along x from one side to the other and slowly farther from the middle plane: its centre follows
# the surface offset by the ball's radius less the depth. Upside down the mallet's mass centre is straight above it.
BEGIN {
  a = 40; b = 30; c = 25     # semi-axes [mm]; the ellipsoid's centre is at z = c
  r = 4; depth = 2           # the half ball and how deep it is pressed, along the normal [mm]
  arm = 67.434               # from the half ball's centre to the mass centre [mm]
  x_end = 28                 # the point of contact goes from -x_end to x_end [mm]
  y_begin = -2; y_end = -6   # and from y_begin to y_end [mm]
  down = 8; rest = 3; along = 50; step_s = 0.03
  print "# The mallet's tail along an ellipsoid at constant normal depth. Written by mallet-along-ellipsoid.awk."
  print "time_s,x_m,y_m,z_m,qw,qx,qy,qz"
  for (i = 0; i <= down + rest + along; ++i) {
    sink = i < down ? -0.4 + (depth + 0.4) * i / down : depth
    share = i < down + rest ? 0 : (i - down - rest) / along
    x = x_end * (2 * share - 1); y = y_begin + (y_end - y_begin) * share
    z = c * sqrt(1 - (x / a) ^ 2 - (y / b) ^ 2)
    nx = x / a ^ 2; ny = y / b ^ 2; nz = z / c ^ 2
    out = (r - sink) / sqrt(nx ^ 2 + ny ^ 2 + nz ^ 2)
    printf "%.2f,%.9f,%.9f,%.9f,0,1,0,0\n", i * step_s, (x + out * nx) / 1e3, (y + out * ny) / 1e3, \
           (c + z + out * nz + arm) / 1e3
  }
}
