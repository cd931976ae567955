% Tasks 7 to 9: J, viscous and Coulomb friction from A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M.
v = course_values();
[t, omega, Iq, T] = load_traces('JLoadAndFriction');
alpha = num_derivative(omega, T);
M = torqueconstant(Iq) .* Iq;
[alpha_filt, sync] = filtered(alpha);
figure;
four_graphs(t, omega, alpha, t(sync), alpha_filt, M, '-');
keep_figure('task07');
show('largest speed', max(abs(omega)), 'rad/s');
show('largest acceleration', max(abs(alpha)), 'rad/s^2');
show('largest torque', max(abs(M)), 'N*m');

fast = abs(omega(sync)) >= 20;
kept = sync(fast);
hold on  % the remaining samples over the originals
four_graphs(t(kept), omega(kept), alpha(kept), t(kept), alpha_filt(fast), M(kept), '.');
keep_figure('task08');
show('samples remaining', sum(fast), '1');
show('samples removed', numel(t) - sum(fast), '1');

A = [alpha_filt(fast), omega(kept), sign(omega(kept))];
theta = A \ M(kept);
show('J', theta(1) * 1e4, 'kg*cm^2');
show('K_fric_w', theta(2), 'N*m*s/rad');
show('K_fric_0', theta(3), 'N*m');
show('E', sum((M(kept) - A * theta).^2), '(N*m)^2');
show('J_load', (theta(1) - v.rotor_inertia.value) * 1e4, 'kg*cm^2');
M_est = [alpha_filt, omega(sync), sign(omega(sync))] * theta;
figure;
plot(t, M, t(sync), M_est); xlabel('t_{sync} / s'); ylabel('torque / (N*m)'); legend('M', 'M_{est}'); grid on
keep_figure('task09');
