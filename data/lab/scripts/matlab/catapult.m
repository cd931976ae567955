% Task 1: the path z = a*y^2 + b*y + c of all flights in the least-squares sense.
points = dlmread(data_file(fullfile('recordings', 'flights.csv')), ',', 1, 0);
y = points(:, 2);
z = points(:, 3);
A = [y.^2, y, ones(size(y))];
theta = A \ z;
show('a', theta(1), '1/m');
show('b', theta(2), '1');
show('c', theta(3), 'm');
show('E', sum((z - A * theta).^2), 'm^2');
figure;
along = linspace(min(y), max(y), 300);
plot(y, z, '.', along, polyval(theta, along), '-'); xlabel('y / m'); ylabel('z / m'); grid on
keep_figure('task01');
