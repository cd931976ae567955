% Tasks 5 and 6: J as the mean of M/alpha where the axis accelerates hard; J_load beside the theory of the disk.
v = course_values();
[t, omega, Iq, T] = load_traces('JLoadWithoutFriction');
alpha = num_derivative(omega, T);
M = torqueconstant(Iq) .* Iq;
[alpha_filt, sync] = filtered(alpha);
figure;
four_graphs(t, omega, alpha, t(sync), alpha_filt, M, '-');
keep_figure('task05');

alpha_max = max(abs(alpha));
hard = abs(alpha) >= alpha_max / 4;
J = mean(M(hard) ./ alpha(hard));
show('largest speed', max(abs(omega)), 'rad/s');
show('largest acceleration', alpha_max, 'rad/s^2');
show('largest torque', max(abs(M)), 'N*m');
show('alpha_max', alpha_max, 'rad/s^2');
show('J', J * 1e4, 'kg*cm^2');
show('J_load', (J - v.rotor_inertia.value) * 1e4, 'kg*cm^2');
show('J_load, theory', v.disk_inertia.value * 1e4, 'kg*cm^2');
show('RMS of M - J·α', sqrt(mean((M(hard) - J * alpha(hard)).^2)), 'N*m');
figure;
plot(t, M, t, J * alpha); xlabel('time / s'); ylabel('torque / (N*m)'); legend('M', 'J*alpha'); grid on
keep_figure('task06');
